// veridyn track STUDY: recursive identification, replayed or from a log that is still being written.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/veridyn/drive.hpp"
#include "apps/veridyn/output.hpp"
#include "veridyn/aircraft/track_flight.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/io/results/estimate_json.hpp"
#include "veridyn/io/tables/csv.hpp"
#include "veridyn/report/document/html.hpp"
#include "veridyn/report/tracking_report.hpp"
#include "veridyn/vehicle/model/vehicle.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::aircraft;
using Clock = std::chrono::steady_clock;

struct Options {
  std::string study;
  bool live = false;
  FollowOptions follow;
  CommonOptions common;
};

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
      text += fmt::format(" {}{} {:.4g} +- {}{}", held ? "[" : "", r.names()[static_cast<std::size_t>(i)], r.theta()(i),
                          band, held ? "]" : "");
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
    lines_ = static_cast<std::size_t>(std::count(table.begin(), table.end(), '\n'));
    fmt::print(stderr, "{}", table);
  }

 private:
  bool quiet_;
  bool terminal_;
  std::size_t lines_ = 0;
  Clock::time_point shown_ = Clock::time_point::min() + std::chrono::hours(1);
};

void write_results(const Options& options, const Study& study, const FlightStudy& flight_study,
                   const TrackedFlight& flight) {
  const std::filesystem::path folder = options.common.out;
  make_folder(folder);
  const FlightTracker& tracker = flight.tracker();
  io::write_csv(history_recording(tracker), folder / "track.csv");
  std::string changes = "coefficient,kind,detected[s],began[s],shift\n";
  for (const FlightChange& c : tracker.changes()) {
    changes += fmt::format("{},{},{},{},{}\n", name_of(c.coefficient),
                           c.change.kind == estimation::ChangeKind::kMean ? "mean" : "spread", c.change.detected_s,
                           c.change.began_s, c.change.shift);
  }
  write_file(folder / "changes.csv", changes);
  const estimation::Estimate estimate = tracker.estimate();
  write_file(folder / "estimate.json", io::to_json(estimate));
  report::write_html(report::tracking_report(flight_study, flight, "veridyn " VERIDYN_VERSION), folder / "report.html");
  RunRecord run{"track", study.name(), study.to_toml(), flight_study.seed, flight_study.inputs};
  run.inputs.emplace_back(options.study);
  if (!flight_study.track.estimate_file.empty()) run.inputs.emplace_back(flight_study.track.estimate_file);
  write_run_record(folder, run, options.common);
  tell(options.common, estimate.verdict);
  tell(options.common,
       fmt::format("changes found: {}; report: {}", tracker.changes().size(), (folder / "report.html").string()));
  nlohmann::ordered_json summary;
  summary["verdict"] = estimate.verdict;
  summary["folder"] = folder.string();
  summary["rows"] = tracker.rows();
  summary["changes"] = nlohmann::ordered_json::array();
  for (const FlightChange& c : tracker.changes())
    summary["changes"].push_back({{"coefficient", name_of(c.coefficient)}, {"detected_s", c.change.detected_s}});
  summary["warnings"] = estimate.warnings;
  print_summary(summary, options.common);
}

int replay(const Options& options, const Study& study) {
  TerminalProgress progress(options.common.quiet);
  FlightStudy flight_study = read_study(study, progress);
  const TrackingAnalysis analysis = track_flight(flight_study, progress);
  if (analysis.interrupted) {
    fmt::print(stderr, "veridyn: interrupted, nothing was written\n");
    return kFailed;
  }
  for (const FlightChange& c : analysis.flight.tracker().changes()) tell(options.common, change_line(c));
  if (!options.common.quiet) fmt::print(stderr, "{}", live_table(analysis.flight));
  write_results(options, study, flight_study, analysis.flight);
  return kDone;
}

int follow(const Options& options, const Study& study) {
  LiveView view(options.common);
  std::optional<FlightStudy> flight_study;
  std::optional<TrackedFlight> flight;
  follow_files(followed_files(study.root()), options.follow, options.common, [&](bool finished) {
    Progress silent;
    flight_study = read_study(study, silent);
    if (!flight) flight.emplace(*flight_study);
    view.show(*flight, flight->advance(flight_study->mapped, *flight_study, finished, silent));
  });
  write_results(options, study, *flight_study, *flight);
  return kDone;
}

int track(const Options& options) {
  const Study study = load_study(options.study, options.common);
  if (vehicle::is_vehicle_study(study.root()))
    return track_vehicle(study, options.study, options.live, options.follow, options.common);
  return options.live ? follow(options, study) : replay(options, study);
}

}  // namespace

void add_track(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = program.add_subcommand("track", "recursive identification, replayed or live, with change detection");
  verb->add_option("STUDY", options->study, "study file; its table [track] holds the options")->required();
  verb->add_flag("--live", options->live, "follow the recording while it is being written");
  verb->add_option("--idle", options->follow.idle_s, "with --live: end this long after the last new data")
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->type_name("SECONDS");
  verb->add_option("--interval", options->follow.interval_s, "with --live: look for new data this often")
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->type_name("SECONDS");
  add_common(*verb, options->common, "out/track", "veridyn track study.toml --live --out out/today");
  verb->callback([options, &exit_code] { exit_code = track(*options); });
}

}  // namespace veridyn::app
