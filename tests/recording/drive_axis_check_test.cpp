#include "veridyn/recording/drive_axis_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "veridyn/core/constants.hpp"

namespace veridyn::recording {
namespace {

using enum InertialChannel;

/// A drive of two minutes through bends, up and down hills: sideslip, roll on the springs, a banked road, sensor noise,
/// a speed that comes 0.2 s late, gravity in the accelerations.
DriveMotion drive(unsigned seed, double liveliness = 1.0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto phase = [&] { return 6.28 * std::generate_canonical<double, 53>(random); };
  const double p1 = phase(), p2 = phase(), p3 = phase(), p4 = phase(), p5 = phase();
  DriveMotion m;
  constexpr std::size_t n = 6000;
  const auto speed = [&](double t) {
    return 18.0 + liveliness * (4.0 * std::sin(0.21 * t + p1) + 2.0 * std::sin(0.5 * t + p2));
  };
  double yaw = 0.3, x = 0.0, y = 0.0;
  const auto put = [&](InertialChannel s, double value) { m.signals[s].push_back(value); };
  for (std::size_t k = 0; k < n; ++k) {
    const double t = m.step * static_cast<double>(k), h = 1e-4;
    const double v = speed(t), dv = (speed(t + h) - speed(t - h)) / (2.0 * h);
    const auto rate = [&](double at) {
      return liveliness * (0.12 * std::sin(0.33 * at + p3) + 0.05 * std::sin(1.1 * at + p4));
    };
    const double r = rate(t), dr = (rate(t + h) - rate(t - h)) / (2.0 * h);
    const double ay = v * r - 0.8 * dr;  // with some change of the lateral velocity
    const double grade = 0.03 * std::sin(0.07 * t + p5), bank = 0.02 * std::sin(0.11 * t + p2);
    const double roll = 0.006 * ay + bank, pitch = -0.005 * dv - grade;
    const auto roll_at = [&](double at) { return 0.006 * speed(at) * rate(at) + 0.02 * std::sin(0.11 * at + p2); };
    put(kAccelX, dv - kGravity * std::sin(pitch) + 0.3 * normal(random));
    put(kAccelY, ay + kGravity * std::sin(roll) + 0.3 * normal(random));
    put(kAccelZ, kGravity + 0.5 * normal(random));
    put(kGyroX, (roll_at(t + h) - roll_at(t - h)) / (2.0 * h) + 0.003 * normal(random));
    put(kGyroY, 0.003 * normal(random));
    put(kGyroZ, r + 0.003 * normal(random));
    put(kRoll, roll + 0.001 * normal(random));
    put(kPitch, pitch);
    put(kYaw, yaw);
    put(kSpeed, speed(t - 0.2) + 0.05 * normal(random));
    put(kSteer, 2.7 * r / v * (1.0 + 0.002 * v * v) + 0.001 * normal(random));
    put(kPosX, x + 0.02 * normal(random));
    put(kPosY, y + 0.02 * normal(random));
    yaw += r * m.step;
    x += v * std::cos(yaw) * m.step;
    y += v * std::sin(yaw) * m.step;
  }
  return m;
}

void scale(DriveMotion& m, const std::vector<InertialChannel>& signals, double factor) {
  for (const InertialChannel s : signals) {
    for (double& v : m.signals[s]) v *= factor;
  }
}

std::vector<std::string> lines_of(const DriveAxisCheck& check) {
  std::vector<std::string> lines;
  for (const auto& others : check.or_else) {
    for (const DriveFault& f : others) lines.insert(lines.end(), f.lines.begin(), f.lines.end());
  }
  for (const DriveFault& f : check.faults) lines.insert(lines.end(), f.lines.begin(), f.lines.end());
  return lines;
}

TEST(DriveAxisCheck, FindsNothingInTwoHundredCleanDrives) {
  int alarms = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const DriveAxisCheck check = check_drive_axes(drive(seed));
    alarms += check.faults.empty() ? 0 : 1;
    EXPECT_GE(check.relations.size(), 6U);
  }
  EXPECT_EQ(alarms, 0);
}

TEST(DriveAxisCheck, NamesEverySingleFaultAndItsLineMendsIt) {
  struct OneFault {
    const char* what;
    std::vector<InertialChannel> signals;
    double factor;
    const char* line;
  };
  const std::vector<OneFault> faults = {
      {"accel_x has the wrong sign", {kAccelX}, -1.0, "accel_x = { channel = \"accel_x\", scale = -1 }"},
      {"accel_y has the wrong sign", {kAccelY}, -1.0, "accel_y = { channel = \"accel_y\", scale = -1 }"},
      {"accel_z has the wrong sign", {kAccelZ}, -1.0, "accel_z = { channel = \"accel_z\", scale = -1 }"},
      {"gyro_z has the wrong sign", {kGyroZ}, -1.0, "gyro_z = { channel = \"gyro_z\", scale = -1 }"},
      {"yaw has the wrong sign", {kYaw}, -1.0, "yaw = { channel = \"yaw\", scale = -1 }"},
      {"steer has the wrong sign", {kSteer}, -1.0, "steer = { channel = \"steer\", scale = -1 }"},
      {"specific force is the opposite", {kAccelX, kAccelY, kAccelZ}, -1.0, "scale = -1"},
      {"in g, not m/s^2", {kAccelX, kAccelY, kAccelZ}, 1.0 / kGravity, "scale = 9.80665"},
      {"in deg/s, not rad/s", {kGyroX, kGyroY, kGyroZ}, 1.0 / kDegree, "scale = 0.0174533"},
      {"angles are in deg", {kRoll, kPitch, kYaw}, 1.0 / kDegree, "scale = 0.0174533"},
      {"speed is in km/h", {kSpeed}, 3.6, "speed = { channel = \"speed\", scale = 0.277778 }"},
      {"speed is in mph", {kSpeed}, 2.2369, "speed = { channel = \"speed\", scale = 0.447047 }"},
      {"frd (y right, z down)", {kAccelY, kAccelZ, kGyroY, kGyroZ, kPitch, kYaw, kSteer}, -1.0, "frame = \"frd\""},
      {"the hand wheel's angle", {kSteer}, 15.0, "steering_wheel = \"steer\""},
      {"it is in deg, not rad", {kSteer}, 1.0 / kDegree, "steer = { channel = \"steer\", scale = 0.0174533 }"},
  };
  for (const OneFault& fault : faults) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      DriveMotion m = drive(seed);
      scale(m, fault.signals, fault.factor);
      const DriveAxisCheck check = check_drive_axes(m);
      ASSERT_EQ(check.faults.size(), 1U) << fault.what << " seed " << seed;
      EXPECT_THAT(lines_of(check), ::testing::Contains(::testing::HasSubstr(fault.line))) << fault.what;
      // Nothing but the accelerometer's rest tells frd from flu: all else turns around together.
      const bool frame = std::string(fault.line).starts_with("frame") || fault.signals.front() == kAccelZ;
      ASSERT_EQ(check.or_else.size(), frame ? 1U : 0U) << fault.what;
      EXPECT_THAT(frame && fault.factor == -1.0 && fault.signals.size() == 1 ? check.or_else[0][0].text
                                                                             : check.faults.front().text,
                  ::testing::HasSubstr(fault.what));
      EXPECT_GT(check.faults.front().correlation, 0.6);
    }
  }
}

TEST(DriveAxisCheck, LeadsExchangedAxesBack) {
  DriveMotion m = drive(3);
  std::swap(m.signals[kAccelX], m.signals[kAccelY]);
  const DriveAxisCheck check = check_drive_axes(m);
  ASSERT_EQ(check.faults.size(), 1U);
  EXPECT_EQ(lines_of(check), (std::vector<std::string>{"accel_x = { channel = \"accel_y\", scale = 1 }",
                                                       "accel_y = { channel = \"accel_x\", scale = 1 }"}));
  // Upward for forward, and the sign of what was forward besides.
  DriveMotion turned = drive(4);
  std::swap(turned.signals[kAccelX], turned.signals[kAccelZ]);
  const DriveAxisCheck other = check_drive_axes(turned);
  ASSERT_FALSE(other.faults.empty());
  EXPECT_EQ(other.faults.front().lines.front(), "accel_x = { channel = \"accel_z\", scale = 1 }");
}

TEST(DriveAxisCheck, NamesTwoFaultsAtOnceAndWhatIsAsLikely) {
  DriveMotion m = drive(5);
  scale(m, {kSpeed}, 3.6);
  scale(m, {kAccelY}, -1.0);
  const DriveAxisCheck two = check_drive_axes(m);
  ASSERT_EQ(two.faults.size(), 2U);
  // Without yaw and steer nothing tells the accelerometer from the gyro.
  DriveMotion less = drive(6);
  scale(less, {kGyroZ}, -1.0);
  less.signals[kYaw].clear();
  less.signals[kSteer].clear();
  const DriveAxisCheck either = check_drive_axes(less);
  ASSERT_EQ(either.faults.size(), 1U);
  ASSERT_EQ(either.or_else.size(), 1U);
}

TEST(DriveAxisCheck, SaysWhereThereIsTooLittleOrNothingFits) {
  const DriveAxisCheck calm = check_drive_axes(drive(7, 0.01));
  EXPECT_TRUE(calm.faults.empty());
  EXPECT_THAT(calm.notes, ::testing::Contains(::testing::HasSubstr("too little of it to compare")));
  DriveMotion odd = drive(8);
  scale(odd, {kAccelX}, 0.2);
  const DriveAxisCheck check = check_drive_axes(odd);
  EXPECT_TRUE(check.faults.empty());
  EXPECT_THAT(check.notes,
              ::testing::Contains(::testing::HasSubstr("accel_x against the change of speed: does not fit")));
  DriveMotion foreign = drive(9);
  std::mt19937 random(1);
  for (double& v : foreign.signals[kAccelX]) v = std::normal_distribution<double>(0.0, 2.0)(random);
  EXPECT_THAT(check_drive_axes(foreign).notes, ::testing::Contains(::testing::HasSubstr("accel_x against the change")));
}

TEST(DriveAxisCheck, GravityTwiceIsNoted) {
  DriveMotion m = drive(11);
  for (double& v : m.signals[kAccelZ]) v += kGravity;
  EXPECT_THAT(check_drive_axes(m).notes, ::testing::Contains(::testing::HasSubstr("gravity is counted twice")));
}

TEST(DriveAxisCheck, OfNothingThereIsNothing) {
  EXPECT_TRUE(check_drive_axes({}).relations.empty());
  EXPECT_TRUE(check_drive_axes(drive_motion(Recording{})).faults.empty());
}

}  // namespace
}  // namespace veridyn::recording
