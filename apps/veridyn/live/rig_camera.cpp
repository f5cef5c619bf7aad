// veridyn rig camera STUDY: what a camera above the virtual car sees, followed as `veridyn camera track` does.
#include "apps/veridyn/live/rig_camera.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "apps/veridyn/live/pose_sender.hpp"
#include "apps/veridyn/run/console.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "veridyn/camera/calibration/calibration_file.hpp"
#include "veridyn/camera/rendering/virtual_camera.hpp"
#include "veridyn/camera/tracking/pose_tables.hpp"
#include "veridyn/camera/tracking/video_frames.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/io/packets/known_packets.hpp"
#include "veridyn/io/packets/packet_decoder.hpp"
#include "veridyn/live/rig/live_study.hpp"
#include "veridyn/numerics/rotation.hpp"
#ifdef VERIDYN_HAS_SOCKETS
#include "veridyn/live/link/udp_socket.hpp"
#endif

namespace veridyn::app {
namespace {

#ifdef VERIDYN_HAS_SOCKETS

using namespace veridyn::live;

/// Markers that a car of half a metre has room for.
const camera::MarkerLayout kMarkers{.markers = {{0.20, 0.0}, {-0.16, 0.10}, {-0.12, -0.08}}};

/// Takes in where the car says that it truly is, until a time.
class TruthReceiver {
 public:
  explicit TruthReceiver(const Sender& at)
      : socket_(at, "live.car.truth"),
        decoder_(io::known_packet("veridyn")),
        values_(decoder_.layout().fields.size()) {}
  void receive(Nanoseconds until, camera::VirtualCamera& camera) {
    static_cast<void>(socket_.wait(until));
    while (const auto datagram = socket_.receive()) {
      if (!decoder_.decode(datagram->bytes, values_)) continue;
      const io::PacketMotion m = decoder_.motion(values_);
      camera.place(m.time, {m.position.x(), m.position.y(), numerics::euler_from_quaternion(m.attitude).psi});
    }
  }

 private:
  UdpSocket socket_;
  io::PacketDecoder decoder_;
  std::vector<double> values_;
};

camera::TrackerOptions tracker_of(const StudyTable& table) {
  camera::TrackerOptions options = camera::TrackerOptions::keys().read(table);
  if (!table.has("markers_x")) options.layout.markers = kMarkers.markers;
  table.finish();
  return options;
}

int rig_camera(const Arguments& arguments) {
  const CommonOptions& common = arguments.common;
  const std::string path = arguments.text("STUDY");
  const StudyRun run = parse_study("rig", path, read_file(path), arguments);
  const LiveStudy study = read_live_study(run.study);
  const StudyTable live = run.study.root().table("live");
  if (!study.camera) live.fail("camera", "is missing: its address is where poses are sent from");
  if (!study.car || !study.car->truth)
    live.fail("car", "has no truth = \"ADDRESS\", where the virtual car says where it is");
  const StudyTable table = live.table("camera");
  const camera::TrackerOptions tracking = tracker_of(table.table_or_empty("tracker"));
  const StudyTable view_table = table.table_or_empty("view");
  const camera::VirtualCameraOptions view = camera::VirtualCameraOptions::keys().read(view_table);
  view_table.finish();
  OutputFolder folder(common.out);
  camera::VirtualCamera seen(view, tracking.layout, study.cueing.seed);
  camera::CarTracker tracker(seen.calibration(), tracking);
  ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  std::optional<camera::VideoWriter> video;
  if (const std::string& file = arguments.text("--video"); !file.empty())
    video.emplace(file, view.width, view.height, view.rate_Hz);
  TruthReceiver truth(*study.car->truth);
  PoseSender sender(table.text("address"), table.place("address"));
  ignore_broken_pipes();
  print_line(common, fmt::format("camera of {} x {} px at {:g} Hz sends poses at {}", view.width, view.height,
                                 view.rate_Hz, table.text("address")));
  RealClock clock;
  const double length = arguments.number("--seconds"), begin = seconds(clock.now());
  std::vector<camera::TrackedPose> poses;
  std::size_t recognised = 0, missed = 0;
  double next = begin;
  const auto over = [&](double now) {
    return common.interruption.requested() || (length > 0.0 && now - begin >= length);
  };
  for (double now = begin; !over(now); now = seconds(clock.now())) {
    truth.receive(clock.now() + 2 * kMillisecond, seen);
    if (!seen.knows(next)) {
      // Nobody drives yet, or nobody does any longer: pictures go on from the next place.
      constexpr double kNobody_s = 0.5;
      if (now > next + kNobody_s) next = now;
      continue;
    }
    const camera::GreyImage picture = seen.picture(next);
    const camera::TrackedPose& pose = poses.emplace_back(tracker.add(next, picture.view()));
    recognised += pose.status == camera::TrackStatus::kMeasured ? 1 : 0;
    sender.send(pose, nanoseconds(next));
    if (video) video->add(picture);
    next += 1.0 / view.rate_Hz;
    // A machine that is too slow for the rate leaves pictures out, as a camera does.
    for (now = seconds(clock.now()); now - next > 2.0 / view.rate_Hz; next += 1.0 / view.rate_Hz) ++missed;
  }
  folder.write("poses.csv", camera::poses_csv(poses));
  folder.write("measured_poses.csv", camera::measured_poses_csv(poses));
  folder.write("calibration.toml", camera::to_toml(seen.calibration()));
  folder.publish(run.record(study.cueing.seed, {}), common,
                 Summary::object({{"folder", folder.path().string()},
                                  {"frames", poses.size()},
                                  {"measured", recognised},
                                  {"missed", missed}}));
  print_line(common, fmt::format("{} pictures, {} left out; the car was recognised in {}; wrote poses.csv, "
                                 "measured_poses.csv, calibration.toml in {}",
                                 poses.size(), missed, recognised, folder.path().string()));
  return kDone;
}

#else

int rig_camera(const Arguments&) {
  throw InputError("rig", "this program was built without sockets (see VERIDYN_SOCKETS)");
}

#endif

}  // namespace

Command rig_camera_command() {
  return {.name = "camera",
          .summary = "a camera above the virtual car: renders what it sees, follows the car, sends its poses",
          .arguments = {{.name = "STUDY", .help = "study file with [live.camera] and live.car.truth", .required = true},
                        {.name = "--seconds", .help = "end after this time; 0: with Ctrl-C", .value = 0.0},
                        {.name = "--video", .help = "write the pictures to this file, too (.avi)", .type = "FILE"}},
          .default_out = "out/rig_camera",
          .example =
              "veridyn rig camera examples/live/car.toml --set live.car.truth=127.0.0.1:4130 --set "
              "live.camera.address=127.0.0.1:6123",
          .run = rig_camera};
}

}  // namespace veridyn::app
