// veridyn track STUDY of a vehicle's drive: cornering stiffnesses on line, replayed or live.
#include <fmt/format.h>

#include <optional>

#include "apps/veridyn/live/follow.hpp"
#include "apps/veridyn/results/analysis_results.hpp"
#include "apps/veridyn/results/drive_results.hpp"
#include "apps/veridyn/results/study_tables.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/version.hpp"
#include "apps/veridyn/run/work_progress.hpp"
#include "veridyn/io/tables/csv.hpp"
#include "veridyn/report/document/html.hpp"
#include "veridyn/report/drive_report.hpp"
#include "veridyn/report/drive_tracking_report.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::vehicle;

std::string change_line(const DriveChange& c) {
  return fmt::format("{:9.1f} s  {} changed, began at about {:.1f} s", c.change.detected_s, kTrackedAxleNames[c.axle],
                     c.change.began_s);
}

std::string live_line(const TrackedDrive& drive) {
  const DriveTracker* t = drive.tracker();
  if (t == nullptr) return "waits for the drive to begin";
  std::string text = fmt::format("{:9.1f} s ", t->last_time());
  for (const TrackedAxle axle : kAllTrackedAxles) {
    text += fmt::format(" {} {:.4g} +- {:.2g}", kTrackedAxleNames[axle], t->value(axle), t->sigma(axle));
  }
  return text;
}

void publish_tracking(const StudyRun& run, OutputFolder& folder, const PreparedDrive& drive,
                      const TrackedDrive& tracked) {
  std::string changes = "what,kind,detected[s],began[s],shift\n";
  std::size_t count = 0;
  Summary found = Summary::array();
  if (const DriveTracker* tracker = tracked.tracker()) {
    folder.write("track.csv", io::to_csv(history_recording(*tracker)));
    count = tracker->changes().size();
    for (const DriveChange& c : tracker->changes()) {
      const std::string_view name = kTrackedAxleNames[c.axle];
      changes += fmt::format("{},{},{},{},{}\n", name, estimation::kChangeKindNames[c.change.kind], c.change.detected_s,
                             c.change.began_s, c.change.shift);
      found.push_back(Summary::object({{"what", name}, {"detected_s", c.change.detected_s}}));
    }
  }
  folder.write("changes.csv", changes);
  const report::DriveReportContext context{.program = program_name()};
  folder.write("report.html", report::to_html(report::drive_tracking_report(drive.study, tracked, context)));
  publish_analysis(folder, run.record(drive.study.seed, drive.study.inputs), run.options(),
                   {.estimate = tracked.estimate()},
                   {.summary = {{"changes", std::move(found)}}, .lines = {fmt::format("changes found: {}", count)}});
}

void follow_drive(const StudyRun& run, OutputFolder& folder) {
  finish_drive_study(run.study.root(), Progress());
  PreparedDrive drive;
  std::optional<TrackedDrive> tracked;
  WorkProgress work(run, &folder);
  work.quiet_stage("following the recording");
  follow_files(followed_files(run.study.root()), FollowOptions::of(run.arguments), run.options(), [&](bool finished) {
    Progress silent;
    drive.study = vehicle::read_study(run.study, silent);
    if (!tracked) tracked.emplace(drive.study);
    for (const DriveChange& c : tracked->advance(drive.study.log.mapped, finished, silent))
      print_line(run.options(), change_line(c));
    print_line(run.options(), live_line(*tracked));
    work.note(live_line(*tracked));
  });
  publish_tracking(run, folder, drive, *tracked);
}

}  // namespace

int track_vehicle(const StudyRun& run) {
  OutputFolder folder(run.options().out);
  if (run.arguments.flag("--live")) {
    follow_drive(run, folder);
    return kDone;
  }
  WorkProgress progress(run, &folder);
  PreparedDrive drive = prepare_drive(run.study, progress);
  const DriveTracking tracking = vehicle::track(drive.study, progress);
  if (tracking.interrupted) throw Interrupted();
  if (const DriveTracker* tracker = tracking.drive.tracker())
    for (const DriveChange& c : tracker->changes()) print_line(run.options(), change_line(c));
  print_line(run.options(), live_line(tracking.drive));
  publish_tracking(run, folder, drive, tracking.drive);
  return kDone;
}

}  // namespace veridyn::app
