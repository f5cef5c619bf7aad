// `veridyn camera` as its users meet it.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "tests/apps/process.hpp"
#include "tests/apps/program.hpp"
#include "tests/camera/fusion/simulated_sensors.hpp"
#include "tests/camera/rendered_drive.hpp"
#include "tests/support/sanitized.hpp"
#include "veridyn/camera/tracking/pose_tables.hpp"
#include "veridyn/camera/tracking/video_frames.hpp"
#include "veridyn/io/tables/table.hpp"
#include "veridyn/live/camera/pose_client.hpp"

namespace veridyn {
namespace {

using ::testing::HasSubstr;

class CameraProgram : public ProgramTest {};

TEST_F(CameraProgram, CalibratesAndFollowsACarInAVideo) {
  const camera::TrackCamera truth = camera::testing::half_size_camera();
  const std::string points = file("points.csv", camera::to_csv(camera::testing::grid_points(truth, 0.2, 0.15, 1)));
  const Outcome calibrated = run("camera calibrate " + points + " --out " + (folder_ / "camera").string());
  ASSERT_EQ(calibrated.exit_code, 0) << calibrated.text;
  EXPECT_THAT(calibrated.text, HasSubstr("RMS on the track"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "camera/report.html"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "camera/residuals.csv"));

  camera::OverheadScene scene = camera::testing::disturbed_scene(truth, 960, 540);
  scene.lights.erase(scene.lights.begin() + 1);  // over which the car drives in this second
  camera::OverheadRenderer renderer(scene, 1);
  std::vector<camera::GreyImage> images;
  for (int k = 0; k < 30; ++k) images.push_back(renderer.render(k / 30.0));
  const std::string video = (folder_ / "drive.avi").string();
  camera::write_video(video, images, 30.0);
  const std::string calibration = " --calibration " + (folder_ / "camera/calibration.toml").string();
  const Outcome tracked = run("camera track " + video + calibration + " --out " + (folder_ / "out").string());
  ASSERT_EQ(tracked.exit_code, 0) << tracked.text;
  EXPECT_THAT(tracked.text, HasSubstr("30 frames: the car was recognised in"));
  const auto poses = camera::read_poses(in_out("measured_poses.csv"));
  ASSERT_GT(poses.size(), 25U);
  for (const camera::TimedPose& p : poses) {
    const Eigen::Vector3d pose = camera::testing::figure_of_eight(p.time);
    EXPECT_LT((p.pose - pose).head<2>().norm(), 2e-3) << p.time;
  }
  EXPECT_FALSE(camera::read_poses(in_out("poses.csv")).empty());

  // Served over TCP at the video's own pace, with the same poses.
  const auto port = static_cast<std::uint16_t>(44000 + ::getpid() % 2000);
  live::PoseClient client({0x7f000001, port});
  Process served({"camera", "track", video, "--calibration", (folder_ / "camera/calibration.toml").string(), "--serve",
                  fmt::format("127.0.0.1:{}", port), "--out", (folder_ / "served").string()},
                 folder_ / "served.txt");
  live::RealClock clock;
  std::vector<live::CameraPose> received;
  for (const live::Nanoseconds end = clock.now() + 5 * live::kSecond; clock.now() < end && received.size() < 15;) {
    while (const auto d = client.next(clock.now())) received.push_back(live::decode_pose(d->bytes).value());
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(served.wait(), 0) << served.said();
  ASSERT_GE(received.size(), 15U);
  for (const live::CameraPose& p : received) {
    const double time = (p.sequence - 1) / 30.0;
    const auto same =
        std::find_if(poses.begin(), poses.end(), [&](const auto& q) { return std::abs(q.time - time) < 1e-3; });
    ASSERT_NE(same, poses.end());
    EXPECT_LT((p.pose - same->pose).norm(), 1e-9);
    EXPECT_NEAR(live::seconds(p.stamp - received.front().stamp), (p.sequence - received.front().sequence) / 30.0, 1e-6);
  }

  // Its markers alone are no silhouette of a car.
  expect_refusal("camera track " + video + calibration + out() + " --method silhouette",
                 "the car was recognised in none of 30 frames: is the first frame empty");
  // Bad input: one line, and nothing new.
  expect_refusal("camera track " + points + calibration + out(), "points.csv: is no video that can be read");
  expect_refusal("camera track " + video + calibration + out() + " --set tracker.contrasst=3", "contrasst");
  expect_refusal("camera track " + video + calibration + out() + " --set tracker.markers_x=[0.1,-0.1] " +
                     "--set tracker.markers_y=[0,0]",
                 "two markers look the same from both ends");
  expect_refusal("camera track " + video + calibration + out() + " --set tracker.markers_x=[0.3,-0.3,0.1] " +
                     "--set tracker.markers_y=[0,0,0.2]",
                 "the car was recognised in none of 30 frames");
}

/// A program that follows a car before a camera: half the size of full HD, 45 pictures in a second and a half.
class CameraDeviceProgram : public CameraProgram {
 protected:
  static constexpr int kWidth = 960, kHeight = 540, kPictures = 45;
  static constexpr double kRate = 30.0;

  void SetUp() override {
    if (test::kSanitized) GTEST_SKIP() << "the sanitizer's library has to be loaded first";
    const camera::TrackCamera truth = camera::testing::half_size_camera();
    const std::string points = file("points.csv", camera::to_csv(camera::testing::grid_points(truth, 0.2, 0.15, 1)));
    ASSERT_EQ(run("camera calibrate " + points + " --out " + (folder_ / "camera").string()).exit_code, 0);
    camera::OverheadScene scene = camera::testing::disturbed_scene(truth, kWidth, kHeight);
    scene.lights.erase(scene.lights.begin() + 1);
    camera::OverheadRenderer renderer(scene, 1);
    std::string pictures;
    for (int k = 0; k < kPictures; ++k) {
      const camera::GreyImage image = renderer.render(k / kRate);
      pictures.append(reinterpret_cast<const char*>(image.pixels.data()), image.pixels.size());
    }
    plug_in_camera(kDevice, file("pictures.raw", pictures), kWidth, kHeight, kRate);
  }
  [[nodiscard]] std::string track(const std::string& device = kDevice) const {
    return "camera track " + device + " --calibration " + (folder_ / "camera/calibration.toml").string() + " --out " +
           (folder_ / "out").string();
  }
  /// Places of single pictures; the first one that the camera gave may be any.
  void expect_poses(std::size_t least) const {
    const auto poses = camera::read_poses(in_out("measured_poses.csv"));
    ASSERT_GE(poses.size(), least);
    double best = kInfinity;
    for (int first = 0; first < kPictures; ++first) {
      double worst = 0.0;
      for (const camera::TimedPose& p : poses)
        worst = std::max(worst, (p.pose - camera::testing::figure_of_eight(first / kRate + p.time)).head<2>().norm());
      best = std::min(best, worst);
    }
    EXPECT_LT(best, 2e-3) << "places and the driver's stamps go together";
  }

  // A character device that nothing else here opens.
  static constexpr const char* kDevice = "/dev/full";
};

TEST_F(CameraDeviceProgram, FollowsACarForAsLongAsItIsTold) {
  const Outcome tracked = run(track() + " --seconds 0.8");
  ASSERT_EQ(tracked.exit_code, 0) << tracked.text;
  EXPECT_THAT(tracked.text, HasSubstr("s of the camera, 960 x 540 px at 30 Hz; following a picture took"));
  EXPECT_THAT(tracked.text, testing::Not(HasSubstr("another clock")));
  expect_poses(5);
}

TEST_F(CameraDeviceProgram, KeepsWhatItHasWhereTheCameraIsUnplugged) {
  const Outcome tracked = run(track());
  ASSERT_EQ(tracked.exit_code, 0) << tracked.text;
  EXPECT_THAT(tracked.text, HasSubstr("warning: /dev/full: gives no more pictures; is it still plugged in?"));
  expect_poses(10);
}

TEST_F(CameraDeviceProgram, EndsWithCtrlCAndKeepsWhatItHas) {
  const Outcome tracked = run_interrupted_after("Ctrl-C ends it", 1, track(), folder_);
  // Unless a busy machine took longer for the first picture: then there is nothing, which it says.
  if (tracked.text.find("recognised in none of 0 frames") != std::string::npos) GTEST_SKIP() << tracked.text;
  EXPECT_EQ(tracked.exit_code, 0) << tracked.text;
  EXPECT_THAT(tracked.text, HasSubstr("s of the camera"));
}

TEST_F(CameraDeviceProgram, SendsPosesWithTheDriversStamps) {
  const auto port = static_cast<std::uint16_t>(42000 + ::getpid() % 2000);
  live::PoseClient client({0x7f000001, port});
  Process served({"camera", "track", kDevice, "--calibration", (folder_ / "camera/calibration.toml").string(),
                  "--serve", fmt::format("127.0.0.1:{}", port), "--out", (folder_ / "out").string()},
                 folder_ / "served.txt");
  live::RealClock clock;
  std::size_t received = 0;
  for (const live::Nanoseconds end = clock.now() + 5 * live::kSecond; clock.now() < end && received < 5;) {
    while (const auto d = client.next(clock.now())) {
      const live::CameraPose pose = live::decode_pose(d->bytes).value();
      EXPECT_LT(pose.stamp, clock.now());
      EXPECT_GT(pose.stamp, clock.now() - live::kSecond);
      ++received;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(served.wait(), 0) << served.said();
  EXPECT_GE(received, 5U);
}

TEST_F(CameraDeviceProgram, SaysWhatACameraCannotDoInOneLine) {
  expect_refusal(track() + " --quiet --set device.width=640 --set device.height=480",
                 "/dev/full: gives 960 x 540 px where 640 x 480 are asked for (device.width, device.height)\n");
  expect_refusal(track() + " --quiet --set device.rate=60",
                 "/dev/full: gives 30 pictures a second where 60 are asked for");
  expect_refusal(track() + " --quiet --set device.width=640", "device.width: needs the other one");
  expect_refusal(track() + " --quiet --set device.format=JPEGS", "must be four letters");
  expect_refusal(track("/dev/null") + " --quiet", "/dev/null: is no camera\n");
  expect_refusal(track("/dev/video_none") + " --quiet",
                 "/dev/video_none: there is no such device; is it plugged in?\n");
}

TEST_F(CameraProgram, SaysInOneLineThatAVideoChangesItsSize) {
  // Motion JPEG one picture behind the other, of two sizes.
  std::string stream;
  for (const int width : {64, 96}) {
    camera::GreyImage image{.width = width, .height = 48, .pixels = {}};
    image.pixels.assign(static_cast<std::size_t>(width) * 48, 90);
    const std::filesystem::path part = folder_ / "part.avi";
    camera::write_video(part, std::vector<camera::GreyImage>(5, image), 25.0);
    const std::string bytes = read_file(part);
    for (std::size_t begin = 0; (begin = bytes.find("\xFF\xD8\xFF", begin)) != std::string::npos;) {
      const std::size_t end = bytes.find("\xFF\xD9", begin) + 2;
      stream += bytes.substr(begin, end - begin);
      begin = end;
    }
  }
  const std::string video = file("changes.mjpeg", stream);
  const camera::TrackCamera truth = camera::testing::half_size_camera();
  const std::string points = file("points.csv", camera::to_csv(camera::testing::grid_points(truth, 0.2, 0.15, 1)));
  ASSERT_EQ(run("camera calibrate " + points + " --out " + (folder_ / "camera").string()).exit_code, 0);
  expect_refusal("camera track " + video + " --calibration " + (folder_ / "camera/calibration.toml").string() + out(),
                 video + ": frame 5 is 96 x 48 px, those before 64 x 48\n");
}

TEST_F(CameraProgram, RefusesPointsThatFitNoMapInOneLine) {
  const std::string header = "world_x,world_y,image_x,image_y\n";
  const std::string three = file("three.csv", header + "0,0,1,1\n1,0,9,1\n1,1,9,9\n");
  expect_refusal("camera calibrate " + three + out(), "three.csv: holds 3 points; a map of the track needs at least 4");
  const std::string line = file("line.csv", header + "0,0,1,1\n1,1,9,1\n2,2,9,9\n3,3,1,9\n");
  expect_refusal("camera calibrate " + line + out(), "line.csv:5: all 4 points up to here are on a line on the track");
  expect_refusal("camera calibrate " + three + out() + " --distortion fisheye", "--distortion");
  EXPECT_THAT(results(), ::testing::IsEmpty());
}

TEST_F(CameraProgram, FusesARecording) {
  camera::testing::SimulatedRun drive = camera::testing::simulated_run({.seed = 3, .duration_s = 20.0});
  std::string inertial =
      "time[s],rate_x[rad/s],rate_y[rad/s],rate_z[rad/s],force_x[m/s^2],force_y[m/s^2],force_z[m/s^2]\n";
  for (const auto& s : drive.inertial)
    inertial += fmt::format("{},{},{},{},{},{},{}\n", s.time, s.rate(0), s.rate(1), s.rate(2), s.force(0), s.force(1),
                            s.force(2));
  std::sort(drive.frames.begin(), drive.frames.end(), [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
  std::vector<camera::TrackedPose> poses;
  for (const auto& f : drive.frames) {
    camera::TrackedPose p{.time = f.stamp};
    p.measured = camera::PoseMeasurement{.pose = f.pose, .noise = f.covariance, .markers = 3};
    poses.push_back(p);
  }
  const std::string imu = file("imu.csv", inertial), seen = file("poses.csv", camera::measured_poses_csv(poses));
  const Outcome fused = run("camera fuse " + imu + " --poses " + seen + " --out " + (folder_ / "out").string());
  ASSERT_EQ(fused.exit_code, 0) << fused.text;
  EXPECT_THAT(fused.text, HasSubstr("the stamps of the camera are"));
  EXPECT_THAT(fused.text, ::testing::Not(HasSubstr("warning")));
  const io::Table motion = io::read_table(in_out("motion.csv"));
  EXPECT_NEAR(motion.at("pitch").value.back(), drive.truth.back().pitch, 2.0 * kDegree);
  EXPECT_GT(motion.at("sigma_pitch").value.back(), 0.0);
  // A sensor that is mounted upside down is noticed.
  std::string wrong = inertial.substr(0, inertial.find('\n') + 1);
  for (const auto& s : drive.inertial)
    wrong += fmt::format("{},{},{},{},{},{},{}\n", s.time, s.rate(0), -s.rate(1), -s.rate(2), s.force(0), -s.force(1),
                         s.force(2));
  const Outcome odd =
      run("camera fuse " + file("odd.csv", wrong) + " --poses " + seen + " --out " + (folder_ / "odd").string());
  EXPECT_THAT(odd.text, HasSubstr("contradict the inertial sensors"));
}

}  // namespace
}  // namespace veridyn
