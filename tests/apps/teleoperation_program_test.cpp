// The full teleoperation loop as its users run it, each part a process, with a camera above the track.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <deque>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/apps/process.hpp"
#include "tests/apps/program.hpp"
#include "tests/support/folders.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/io/packets/known_packets.hpp"
#include "veridyn/io/packets/packet_decoder.hpp"
#include "veridyn/io/tables/table.hpp"
#include "veridyn/live/camera/pose_client.hpp"
#include "veridyn/live/camera/pose_packet.hpp"
#include "veridyn/live/camera/pose_server.hpp"
#include "veridyn/live/link/udp_socket.hpp"
#include "veridyn/live/virtual/motion_packet.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn {
namespace {

using ::testing::HasSubstr;
using namespace live;

/// A camera that sees where the car says that it truly is, 30 times a second, with errors of its own, on a clock of its
/// own, and whose poses come late.
class SeeingCamera {
 public:
  struct Truth {
    double time = 0.0, x = 0.0, y = 0.0, heading = 0.0;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  };
  static constexpr double kPlace = 0.002, kHeading = 0.005, kLate = 0.04;  // [m], [rad], [s]

  SeeingCamera(const Sender& truth, const Sender& served)
      : truth_at_(truth, "truth"), server_(served, "camera"), thread_([this] { run(); }) {}
  ~SeeingCamera() { end(); }
  SeeingCamera(const SeeingCamera&) = delete;
  SeeingCamera& operator=(const SeeingCamera&) = delete;
  void end() {
    over_ = true;
    if (thread_.joinable()) thread_.join();
  }
  [[nodiscard]] const std::vector<Truth>& truth() const { return truth_; }

 private:
  void run() {
    const io::PacketDecoder decoder(io::known_packet("veridyn"));
    std::vector<double> values(decoder.layout().fields.size());
    numerics::RandomStream random(4, "camera");
    std::deque<std::pair<Nanoseconds, PosePacket>> on_the_way;
    Nanoseconds next_frame = 0;
    std::uint32_t sequence = 0;
    while (!over_) {
      static_cast<void>(truth_at_.wait(clock_.now() + 2 * kMillisecond));
      while (const auto d = truth_at_.receive()) {
        if (!decoder.decode(d->bytes, values)) continue;
        const io::PacketMotion m = decoder.motion(values);
        truth_.push_back(
            {m.time, m.position.x(), m.position.y(), numerics::euler_from_quaternion(m.attitude).psi, m.velocity});
        const Nanoseconds at = nanoseconds(m.time);
        if (at < next_frame) continue;
        next_frame = at + kSecond / 30;
        const Truth& t = truth_.back();
        CameraPose pose{.sequence = ++sequence,
                        .stamp = at - 1000 * kSecond,
                        .pose = {t.x + kPlace * random.normal(), t.y + kPlace * random.normal(),
                                 t.heading + kHeading * random.normal()}};
        pose.covariance.diagonal() << kPlace * kPlace, kPlace * kPlace, kHeading * kHeading;
        on_the_way.emplace_back(at + nanoseconds(kLate), encode(pose));
      }
      for (; !on_the_way.empty() && on_the_way.front().first <= clock_.now(); on_the_way.pop_front())
        server_.send({on_the_way.front().second.data(), on_the_way.front().second.size()});
    }
  }

  RealClock clock_;
  UdpSocket truth_at_;
  PoseServer server_;
  std::vector<Truth> truth_;
  std::atomic<bool> over_{false};
  std::thread thread_;
};

class TeleoperationProgramTest : public ProgramTest {
 protected:
  void SetUp() override {
    ProgramTest::SetUp();
    base_ = 46000 + 5 * (static_cast<int>(::getpid()) % 3000);
    study_ = (test::source_folder() / "examples/live/car.toml").string();
    sets_ = {"--set", fmt::format("live.platform=127.0.0.1:{}", base_),
             "--set", fmt::format("live.stop=127.0.0.1:{}", base_ + 1),
             "--set", fmt::format("live.car.truth=127.0.0.1:{}", base_ + 2),
             "--set", fmt::format("live.camera.address=127.0.0.1:{}", base_ + 3),
             "--set", fmt::format("live.car.line={}", (folder_ / "line").string()),
             "--set", "live.fade=1"};
  }
  [[nodiscard]] std::vector<std::string> words(std::vector<std::string> command) const {
    command.insert(command.end(), sets_.begin(), sets_.end());
    return command;
  }
  [[nodiscard]] static Sender at(int port) { return {0x7f000001, static_cast<std::uint16_t>(port)}; }

  int base_ = 0;
  std::string study_;
  std::vector<std::string> sets_;
};

TEST_F(TeleoperationProgramTest, GoesFromPedalToPlatformToTheMotionThatACameraSaw) {
  // A driver for long enough that tracking has learned the sensors' noise: to 3 m/s, a sum of sines, to a stop.
  constexpr double kDrive = 27.0;
  std::string driver = "time[s],steering[rad],throttle,brake\n";
  for (int k = 0; k <= static_cast<int>(20.0 * kDrive); ++k) {
    const double t = k / 20.0;
    const double wheel = t < 3.0 ? 0.0 : 0.35 * std::sin(1.5 * t) + 0.25 * std::sin(4.0 * t) + 0.15 * std::sin(9.0 * t);
    driver += fmt::format("{},{},{},{}\n", t, wheel,
                          t < 1.0            ? 0.0
                          : t < 2.2          ? 0.8
                          : t < kDrive - 2.0 ? 0.045
                                             : 0.0,
                          t < kDrive - 2.0 ? 0.0 : 0.6);
  }
  sets_.insert(sets_.end(), {"--set", "live.driver.table=" + file("driver.csv", driver)});
  SeeingCamera camera(at(base_ + 2), at(base_ + 3));
  Process platform(words({"rig", "platform", study_, "--json"}), folder_ / "platform.txt");
  ASSERT_TRUE(platform.says("takes orders", 20.0)) << platform.said();
  Process car(words({"rig", "car", study_, "--out", (folder_ / "car").string()}), folder_ / "car.txt");
  ASSERT_TRUE(car.says("waits at", 20.0)) << car.said();
  Process rig(words({"cue", study_, "--live", "--start", "--seconds", fmt::format("{}", kDrive + 0.3), "--json",
                     "--out", (folder_ / "run").string()}),
              folder_ / "rig.txt");
  ASSERT_TRUE(rig.says("listening", 20.0)) << rig.said();
  // While it drives, another program follows what is recorded.
  std::filesystem::copy(test::source_folder() / "examples/live/identify_car.toml", folder_ / "identify_car.toml");
  Process track({"track", (folder_ / "identify_car.toml").string(), "--live", "--idle", "3", "--set",
                 "data.file=run/drive_live.csv", "--out", (folder_ / "track").string()},
                folder_ / "track.txt");
  EXPECT_TRUE(track.says("C_f ", kDrive)) << track.said();
  EXPECT_THAT(rig.said(), ::testing::Not(HasSubstr("orders in"))) << "the run was over before the tracking began";
  ASSERT_EQ(rig.wait(), 0) << rig.said();
  camera.end();
  for (Process* one : {&platform, &car}) {
    one->signal(SIGINT);
    EXPECT_EQ(one->wait(), 0) << one->said();
  }
  EXPECT_EQ(track.wait(), 0) << track.said();
  const io::Table tracked = io::read_table(folder_ / "track/track.csv");
  EXPECT_GT(tracked.rows(), 10U);

  // From pedal to platform: the parts add up.
  const std::string said = rig.said();
  const auto json = nlohmann::json::parse(said.substr(said.find("\n{") + 1, said.rfind('}') - said.find("\n{")));
  EXPECT_EQ(json["orders_different_when_replayed"], 0) << said;
  const double whole = json["car"]["pedal_to_platform_s"]["p50"];
  EXPECT_GT(whole, 0.022) << "the motion alone is taken 20 ms late";
  EXPECT_LT(whole, 0.15);
  const std::string delays = read_file(folder_ / "run/delays.toml");
  for (const char* stage : {"_input", "_line", "_car", "_motion", "_answer", ""})
    EXPECT_THAT(delays, HasSubstr(std::string("pedal_to_platform") + stage + " = ["));
  // And the camera's, as keys that a study takes.
  const Study found = Study::parse(delays, "delays.toml");
  const double offset = found.root().table("live").table("camera").table("fusion").number("offset", "s");
  EXPECT_NEAR(offset, json["camera"]["offset_s"].get<double>(), 1e-6);

  // What came over the line is counted, too.
  const std::string packets = read_file(folder_ / "run/packets.csv");
  EXPECT_THAT(packets, HasSubstr("car,accepted,"));
  EXPECT_THAT(packets, ::testing::Not(HasSubstr("car,accepted,0\n")));
  EXPECT_THAT(packets, ::testing::Not(HasSubstr("car,lost,0\n"))) << "one frame of ten is damaged";

  // Camera and inertial sensors: where the car was, which of its sensors' errors the camera took out.
  EXPECT_GT(json["camera"]["poses"].get<int>(), 600);
  EXPECT_EQ(json["camera"]["unreadable"], 0);
  // Poses come 40 ms late, the car's reports by their 2 ms on the line at least.
  EXPECT_NEAR(json["camera"]["offset_s"].get<double>(), SeeingCamera::kLate - 0.002, 0.01);
  const io::Table motion = io::read_table(folder_ / "run/motion.csv");
  double place = 0.0, heading = 0.0, speed = 0.0;
  std::size_t compared = 0, k = 0;
  const std::vector<double>& time = motion.at("time").value;
  for (std::size_t i = time.size() / 3; i < time.size(); ++i) {
    while (k + 1 < camera.truth().size() && camera.truth()[k + 1].time <= time[i]) ++k;
    if (k + 1 == camera.truth().size()) break;
    const SeeingCamera::Truth& t = camera.truth()[k];
    const double dt = time[i] - t.time;
    place = std::max(place, std::hypot(motion.at("x").value[i] - t.x - dt * t.velocity.x(),
                                       motion.at("y").value[i] - t.y - dt * t.velocity.y()));
    heading = std::max(heading, std::abs(std::remainder(motion.at("heading").value[i] - t.heading, 2.0 * kPi)));
    speed = std::max(speed, std::hypot(motion.at("velocity_x").value[i] - t.velocity.x(),
                                       motion.at("velocity_y").value[i] - t.velocity.y()));
    ++compared;
  }
  EXPECT_GT(compared, 400U);
  EXPECT_LT(place, 0.08) << "4 m/s times 10 ms by which clocks may differ, and its own 2 mm";
  EXPECT_LT(heading, 0.05);
  EXPECT_LT(speed, 0.3);
}

// What the virtual car says of itself comes out of pictures again, with its time.
TEST_F(TeleoperationProgramTest, CameraOfTheRigSeesTheVirtualCarWhereItIs) {
  PoseClient client(at(base_ + 3));
  std::vector<std::string> seen = words({"rig", "camera", study_, "--json", "--video", (folder_ / "seen.avi").string(),
                                         "--out", (folder_ / "camera").string()});
  seen.insert(seen.end(), {"--set", "live.camera.view={x=[-3,3],y=[-2,2],width=640,height=480}"});
  Process camera(seen, folder_ / "camera.txt");
  ASSERT_TRUE(camera.says("sends poses", 20.0)) << camera.said();
  UdpSocket truth = UdpSocket::connected(at(base_ + 2), "truth");
  RealClock clock;
  const Nanoseconds begin = clock.now();
  const auto place = [&](Nanoseconds time) {
    const double t = seconds(time - begin);
    return Eigen::Vector3d(2.0 * std::cos(t), 1.2 * std::sin(t), std::remainder(t + 0.5 * kPi, 2.0 * kPi));
  };
  std::size_t received = 0;
  std::uint32_t sequence = 0;
  for (Nanoseconds now = begin; now < begin + 8 * kSecond && received < 20; now = clock.now()) {
    const Eigen::Vector3d pose = place(now);
    std::array<char, kMotionPacketBytes> packet{};
    encode_motion({.sequence = sequence++,
                   .time = seconds(now),
                   .position = {pose(0), pose(1), 0.0},
                   .attitude = Eigen::Quaterniond(Eigen::AngleAxisd(pose(2), Eigen::Vector3d::UnitZ()))},
                  packet);
    EXPECT_TRUE(truth.send({packet.data(), packet.size()}));
    while (const auto datagram = client.next(now)) {
      const CameraPose one = decode_pose(datagram->bytes).value();
      Eigen::Vector3d off = one.pose - place(one.stamp);
      off(2) = std::remainder(off(2), 2.0 * kPi);
      EXPECT_LT(off.head<2>().norm(), 0.01);
      EXPECT_LT(std::abs(off(2)), 0.05);
      EXPECT_LT(one.stamp, now);
      ++received;
    }
    clock.sleep_until(now + 10 * kMillisecond);
  }
  EXPECT_EQ(received, 20U);
  camera.signal(SIGINT);
  EXPECT_EQ(camera.wait(), 0) << camera.said();
  // Its video is one that `veridyn camera track` follows, with its calibration.
  const Outcome tracked =
      run("camera track " + (folder_ / "seen.avi").string() + " --calibration " +
          (folder_ / "camera/calibration.toml").string() +
          " --set tracker.markers_x=[0.2,-0.16,-0.12] --set tracker.markers_y=[0,0.1,-0.08] --out " +
          (folder_ / "tracked").string());
  EXPECT_EQ(tracked.exit_code, 0) << tracked.text;
  EXPECT_THAT(tracked.text, HasSubstr("frames: the car was recognised in"));
}

TEST_F(TeleoperationProgramTest, SaysInOneLineWhatIsWrongWithACamera) {
  const auto refused = [&](const std::string& set, const std::string& why) {
    expect_refusal("cue " + study_ + " --live --set " + set + out(), why);
  };
  refused("live.camera.address=nowhere", "live.camera.address: = 'nowhere' is no address");
  refused("live.camera.addres=127.0.0.1:6123", "live.camera.address");
  expect_refusal("rig camera " + study_ + " --set live.car.truth=127.0.0.1:4130" + out(), "live.camera: is missing");
  expect_refusal("rig camera " + study_ + " --set live.camera.address=127.0.0.1:6123" + out(), "has no truth = ");
  const std::string both = study_ + " --set live.car.truth=127.0.0.1:4130 --set live.camera.address=127.0.0.1:6123";
  expect_refusal("rig camera " + both + " --set live.camera.view={wdth=4}" + out(), "wdth");
  expect_refusal("rig camera " + both + " --set live.camera.view={x=[-50,50]}" + out(),
                 "px apart; must be at least 12");
  refused("'live.camera={address=\"127.0.0.1:6123\",fusion={gyro=-1}}'", "fusion");
  refused("'live.camera={address=\"127.0.0.1:6123\",fusion={gyr=0.1}}'", "gyr");
  const std::string live = (test::source_folder() / "examples/studies/cueing/live.toml").string();
  expect_refusal("cue " + live + " --live --set live.camera.address=127.0.0.1:6123" + out(),
                 "is for telemetry = \"car\"");
}

}  // namespace
}  // namespace veridyn
