#include "apps/veridyn/live/camera_track.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/veridyn/live/pose_sender.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "veridyn/camera/calibration/calibration_file.hpp"
#include "veridyn/camera/tracking/camera_device.hpp"
#include "veridyn/camera/tracking/car_tracker.hpp"
#include "veridyn/camera/tracking/pose_tables.hpp"
#include "veridyn/camera/tracking/silhouette.hpp"
#include "veridyn/camera/tracking/video_frames.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/live/time/clock.hpp"

namespace veridyn::app {
namespace {

using namespace veridyn::camera;

/// Follows the car from picture to picture, by its markers or by its silhouette.
class Follower {
 public:
  Follower(const Calibration& map, const Study& options, bool by_silhouette)
      : map_(map),
        tracker_(map, TrackerOptions::keys().read(options.root().table_or_empty("tracker"))),
        silhouettes_(SilhouetteOptions::keys().read(options.root().table_or_empty("silhouette"))),
        by_silhouette_(by_silhouette) {}

  const TrackedPose& add(double time, const GreyView& view) {
    poses_.push_back(by_silhouette_ ? tracker_.add(time, silhouettes_.find(view, map_)) : tracker_.add(time, view));
    seen_ += poses_.back().status == TrackStatus::kMeasured ? 1 : 0;
    lost_ += poses_.back().status == TrackStatus::kLost ? 1 : 0;
    return poses_.back();
  }
  [[nodiscard]] const std::vector<TrackedPose>& poses() const { return poses_; }
  [[nodiscard]] std::size_t seen() const { return seen_; }
  [[nodiscard]] std::size_t lost() const { return lost_; }
  [[nodiscard]] double variance_factor() const { return tracker_.variance_factor(); }
  /// What to look at where it was never seen.
  [[nodiscard]] std::string never_seen() const {
    return fmt::format("the car was recognised in none of {} frames: {}, and is the calibration of this camera?",
                       poses_.size(),
                       by_silhouette_ ? "is the first frame empty, is the car as large as silhouette.length and "
                                        "silhouette.width say"
                                      : "are the markers where tracker.markers_x and tracker.markers_y say");
  }

 private:
  const Calibration map_;
  CarTracker tracker_;
  SilhouetteFinder silhouettes_;
  bool by_silhouette_;
  std::vector<TrackedPose> poses_;
  std::size_t seen_ = 0, lost_ = 0;
};

void follow_file(VideoFrames& frames, Follower& follower, PoseSender& sender, const Arguments& arguments) {
  live::RealClock clock;
  const live::Nanoseconds start = clock.now();
  while (const auto frame = frames.next()) {
    if (arguments.common.interruption.requested()) throw Interrupted();
    const TrackedPose& pose = follower.add(frame->time, frame->image.view());
    const live::Nanoseconds stamp = start + live::nanoseconds(pose.time);
    if (sender.sends()) clock.sleep_until(stamp);
    sender.send(pose, stamp);
  }
}

/// What a camera gave in how long.
struct CameraTimes {
  double duration = 0.0;   ///< from the first picture to the last [s]
  std::size_t missed = 0;  ///< pictures that the stamps leave room for and nobody took
  double work = 0.0;       ///< of a picture, on average [s]
  bool of_driver = true;   ///< stamps are the driver's, not of their arrival
  std::string ended_by;    ///< what the camera failed by; empty: it did not
};

CameraTimes follow_device(CameraDevice& device, Follower& follower, PoseSender& sender, const Arguments& arguments) {
  live::RealClock clock;
  const double length = arguments.number("--seconds");
  CameraTimes times;
  std::optional<double> first;
  double last = 0.0;
  while (!arguments.common.interruption.requested() && !(length > 0.0 && times.duration >= length)) {
    DeviceFrame frame;
    try {
      frame = device.next();
    } catch (const InputError& error) {
      // What was followed until then is kept, and Ctrl-C ends the waiting for a picture too.
      if (follower.poses().empty()) throw;
      if (!arguments.common.interruption.requested()) times.ended_by = error.what();
      break;
    }
    const double arrived = live::seconds(clock.now());
    // A driver may take its stamps from another clock.
    constexpr double kSameClock = 1.0;
    times.of_driver = times.of_driver && std::abs(arrived - frame.stamp) < kSameClock;
    const double stamp = times.of_driver ? frame.stamp : arrived;
    if (!first) {
      first = stamp;
    } else {
      if (!(stamp > last)) continue;  // the same picture again
      if (device.rate_Hz() > 0.0)
        times.missed += static_cast<std::size_t>(std::max(0.0, std::round((stamp - last) * device.rate_Hz()) - 1.0));
    }
    last = stamp;
    times.duration = stamp - *first;
    sender.send(follower.add(times.duration, frame.image.view()), live::nanoseconds(stamp));
    times.work += live::seconds(clock.now()) - arrived;
  }
  if (!follower.poses().empty()) times.work /= static_cast<double>(follower.poses().size());
  return times;
}

void print_times(const CommonOptions& common, const CameraTimes& times, const CameraDevice& device,
                 std::size_t frames) {
  print_line(common,
             fmt::format("{:.1f} s of the camera, {} x {} px{}; following a picture took {:.1f} ms", times.duration,
                         device.width(), device.height(),
                         device.rate_Hz() > 0.0 ? fmt::format(" at {:g} Hz", device.rate_Hz()) : "", 1e3 * times.work));
  if (!times.ended_by.empty()) print_line(common, "warning: " + times.ended_by);
  if (!times.of_driver)
    print_line(common,
               "warning: the driver's stamps are of another clock; pictures are stamped when they arrive, late by "
               "what the camera takes to hand them over");
  constexpr double kShareLost = 0.01;
  if (static_cast<double>(times.missed) > kShareLost * static_cast<double>(frames + times.missed))
    print_line(common,
               fmt::format("warning: {} pictures were missed: following one takes longer than the camera needs for "
                           "the next, or it gives fewer in the dark (exposure)",
                           times.missed));
}

int track(const Arguments& arguments) {
  const CommonOptions& common = arguments.common;
  OutputFolder folder(common.out);
  const Study options = Study::parse("", "--set", {}, common.overrides);
  const std::filesystem::path source = arguments.text("VIDEO"), calibration = arguments.text("--calibration");
  Follower follower(read_calibration(calibration), options, arguments.text("--method") == "silhouette");
  const CameraDeviceOptions asked = CameraDeviceOptions::keys().read(options.root().table_or_empty("device"));
  options.root().finish();
  // The library behind OpenCV writes lines of its own about files that are no video; -8 is its "quiet".
  ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  TerminalProgress progress = progress_of(common);
  PoseSender sender(arguments.text("--serve"), "--serve");
  std::optional<CameraTimes> times;
  std::error_code ignored;
  const bool is_device =
      std::filesystem::is_character_file(source, ignored) || source.string().starts_with("/dev/video");
  if (is_device) {
    CameraDevice device(source, asked);
    progress.stage(arguments.number("--seconds") > 0.0 ? "following the car" : "following the car; Ctrl-C ends it");
    times = follow_device(device, follower, sender, arguments);
    print_times(common, *times, device, follower.poses().size());
  } else {
    VideoFrames frames(source);
    progress.stage("following the car");
    follow_file(frames, follower, sender, arguments);
  }
  if (follower.seen() == 0) throw InputError(source.string(), follower.never_seen());
  folder.write("poses.csv", poses_csv(follower.poses()));
  folder.write("measured_poses.csv", measured_poses_csv(follower.poses()));
  Summary summary = Summary::object({{"folder", folder.path().string()},
                                     {"frames", follower.poses().size()},
                                     {"measured", follower.seen()},
                                     {"lost", follower.lost()},
                                     {"variance_factor", follower.variance_factor()}});
  std::vector<std::filesystem::path> inputs{calibration};
  if (times) {
    summary["camera"] = Summary::object({{"device", source.string()},
                                         {"duration_s", times->duration},
                                         {"missed", times->missed},
                                         {"work_s", times->work},
                                         {"driver_stamps", times->of_driver}});
  } else {
    inputs.insert(inputs.begin(), source);
  }
  folder.publish(
      {.command = "camera track", .study_name = "", .study_toml = options.to_toml(), .seed = 0, .inputs = inputs},
      common, summary);
  const std::size_t frames = follower.poses().size(), seen = follower.seen(), lost = follower.lost();
  print_line(common, fmt::format("{} frames: the car was recognised in {}, predicted in {}, lost in {}", frames, seen,
                                 frames - seen - lost, lost));
  print_line(common, fmt::format("wrote poses.csv, measured_poses.csv in {}", folder.path().string()));
  return kDone;
}

}  // namespace

Command camera_track_command() {
  return {
      .name = "track",
      .summary = "poses of a car in a video or before a camera, by bright markers or by its silhouette",
      .arguments =
          {{.name = "VIDEO", .help = "video file, or a camera such as /dev/video0", .type = "FILE", .required = true},
           {.name = "--calibration", .help = "calibration.toml of this camera", .type = "FILE", .required = true},
           {.name = "--method",
            .help = "bright markers, or what differs from the first frame, in which the track is empty",
            .value = "markers",
            .choices = {"markers", "silhouette"}},
           {.name = "--serve",
            .help = "send each pose over TCP to whoever connects there, at the video's own pace",
            .value = std::string(""),
            .type = "ADDRESS"},
           {.name = "--seconds", .help = "of a camera: end after this time; 0: with Ctrl-C", .value = 0.0}},
      .default_out = "out/camera_track",
      .example =
          "veridyn camera track drive.avi --calibration camera/calibration.toml --set "
          "tracker.markers_x=[0.1,-0.08,-0.06] --set tracker.markers_y=[0,0.05,-0.04]",
      .run = track};
}

}  // namespace veridyn::app
