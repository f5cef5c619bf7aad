// veridyn track STUDY: recursive identification, replayed or from a log that is still being written.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "apps/veridyn/live/follow.hpp"
#include "apps/veridyn/results/analysis_results.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "apps/veridyn/run/version.hpp"
#include "apps/veridyn/run/work_progress.hpp"
#include "veridyn/aircraft/track_flight.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/io/tables/csv.hpp"
#include "veridyn/report/document/html.hpp"
#include "veridyn/report/tracking_report.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::aircraft;
using Clock = std::chrono::steady_clock;

std::string change_line(const FlightChange& c) {
  return fmt::format("{:9.1f} s  {} changed, began at about {:.1f} s", c.change.detected_s, name_of(c.coefficient),
                     c.change.began_s);
}

/// One line a coefficient: value and sigma of each parameter, those that are held in brackets.
std::string live_table(const TrackedFlight& flight) {
  std::string text = fmt::format("{:9.1f} s  {} rows\n", flight.end_time(), flight.tracker().rows());
  for (const TrackedCoefficient& c : flight.tracker().coefficients()) {
    text += fmt::format("  {} ", name_of(c.model.coefficient));
    if (!c.tracker) {
      text += (c.obstacle.empty() ? "waits for 20 s in the air" : c.obstacle) + "\n";
      continue;
    }
    const auto& r = c.tracker->regression();
    for (Eigen::Index i = 0; i < r.parameters(); ++i) {
      const bool held = r.unexcited_share()(i) > 0.5;
      const double sigma = r.sigma()(i);
      const std::string band = std::isfinite(sigma) ? fmt::format("{:.2g}", sigma) : "?";
      text += fmt::format(" {}{} {:.4g} +- {}{}", held ? "[" : "", r.names()[i], r.theta()(i), band, held ? "]" : "");
    }
    text += "\n";
  }
  return text;
}

/// Draws the table over the one before on a terminal; elsewhere one every ten seconds.
class LiveView {
 public:
  explicit LiveView(const CommonOptions& options) : quiet_(options.quiet), terminal_(::isatty(STDERR_FILENO) != 0) {}

  void show(const TrackedFlight& flight, const std::vector<FlightChange>& changes) {
    if (quiet_) return;
    if (terminal_ && lines_ > 0) fmt::print(stderr, "\033[{}A\033[J", lines_);
    for (const FlightChange& c : changes) fmt::print(stderr, "{}\n", change_line(c));
    if (!terminal_ && Clock::now() - shown_ < std::chrono::seconds(10)) return;
    shown_ = Clock::now();
    const std::string table = live_table(flight);
    lines_ = at(std::count(table.begin(), table.end(), '\n'));
    fmt::print(stderr, "{}", table);
  }

 private:
  bool quiet_;
  bool terminal_;
  std::size_t lines_ = 0;
  Clock::time_point shown_ = Clock::time_point::min() + std::chrono::hours(1);
};

/// What the guarded filter did, where there is one: files, summary and console.
void add_filter(OutputFolder& folder, const FlightStudy& study, const FilterHistory& filter, MoreResults& more) {
  if (filter.empty()) return;
  folder.write("filter.csv", io::to_csv(filter.recording()));
  folder.write("models.csv", models_csv(filter.models()));
  Summary& entry = more.summary.emplace_back("filter", Summary()).second;
  entry["model_based_share"] = filter.model_based_share();
  entry["reverts"] = filter.reverts();
  entry["models"] = filter.models().size();
  more.lines.push_back(filter.statement());
  if (!study.truth) return;
  for (const TrackedFilterError& e : filter.errors(*study.truth)) {
    entry["rms_error"][e.quantity] = Summary::object({{"model_free", e.model_free}, {"guarded", e.guarded}});
    const auto text = [&](double v) { return fmt::format("{:.3g}{}", display_value(v, e.unit), display_unit(e.unit)); };
    more.lines.push_back(
        fmt::format("  {:<9} RMS error: model-free {}, guarded {}", e.quantity, text(e.model_free), text(e.guarded)));
  }
}

void publish_tracking(const StudyRun& run, OutputFolder& folder, const FlightStudy& study,
                      const TrackedFlight& flight) {
  const FlightTracker& tracker = flight.tracker();
  std::string changes = "coefficient,kind,detected[s],began[s],shift\n";
  Summary found = Summary::array();
  for (const FlightChange& c : tracker.changes()) {
    const std::string_view name = name_of(c.coefficient);
    changes += fmt::format("{},{},{},{},{}\n", name, estimation::kChangeKindNames[c.change.kind], c.change.detected_s,
                           c.change.began_s, c.change.shift);
    found.push_back(Summary::object({{"coefficient", name}, {"detected_s", c.change.detected_s}}));
  }
  folder.write("track.csv", io::to_csv(history_recording(tracker)));
  folder.write("changes.csv", changes);
  folder.write("report.html", report::to_html(report::tracking_report(study, flight, program_name())));
  MoreResults more{.summary = {{"rows", tracker.rows()}, {"changes", std::move(found)}},
                   .lines = {fmt::format("changes found: {}", tracker.changes().size())}};
  add_filter(folder, study, flight.filter(), more);
  RunRecord record = run.record(study.seed, study.inputs);
  if (!study.track.estimate_file.empty()) record.inputs.push_back(study.track.estimate_file);
  publish_analysis(folder, record, run.options(), {.estimate = flight.estimate()}, more);
}

void replay(const StudyRun& run, OutputFolder& folder) {
  WorkProgress progress(run, &folder);
  const FlightStudy study = aircraft::read_study(run.study, progress);
  const TrackingAnalysis analysis = track_flight(study, progress);
  if (analysis.interrupted) throw Interrupted();
  for (const FlightChange& c : analysis.flight.tracker().changes()) print_line(run.options(), change_line(c));
  if (!run.options().quiet) fmt::print(stderr, "{}", live_table(analysis.flight));
  publish_tracking(run, folder, study, analysis.flight);
}

void follow_flight(const StudyRun& run, OutputFolder& folder) {
  LiveView view(run.options());
  WorkProgress work(run, &folder);
  work.quiet_stage("following the recording");
  std::optional<FlightStudy> study;
  std::optional<TrackedFlight> flight;
  follow_files(followed_files(run.study.root()), FollowOptions::of(run.arguments), run.options(), [&](bool finished) {
    Progress silent;
    study = aircraft::read_study(run.study, silent);
    if (!flight) flight.emplace(*study);
    view.show(*flight, flight->advance(study->mapped, *study, finished, silent));
    work.note(live_table(*flight));
  });
  Progress silent;
  flight->check_recording(study->mapped, *study, {}, silent);
  publish_tracking(run, folder, *study, *flight);
}

}  // namespace

int track_aircraft(const StudyRun& run) {
  OutputFolder folder(run.options().out);
  run.arguments.flag("--live") ? follow_flight(run, folder) : replay(run, folder);
  return kDone;
}

Command track_command() {
  const FollowOptions follow;
  return {.name = "track",
          .summary = "recursive identification, replayed or live, with change detection",
          .arguments = {{.name = "STUDY", .help = "study file; its table [track] holds the options", .required = true},
                        {.name = "--live", .help = "follow the recording while it is being written", .value = false},
                        {.name = "--idle",
                         .help = "with --live: end this long after the last new data",
                         .value = follow.idle_s,
                         .type = "SECONDS",
                         .positive = true},
                        {.name = "--interval",
                         .help = "with --live: look for new data this often",
                         .value = follow.interval_s,
                         .type = "SECONDS",
                         .positive = true}},
          .default_out = "out/track",
          .example = "veridyn track study.toml --live --out out/today",
          .run = [](const Arguments& arguments) { return run_on_study("track", arguments); }};
}

}  // namespace veridyn::app
