#include "veridyn/recording/consistency.hpp"

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
  m.grid.count = n;
  const auto speed = [&](double t) {
    return 18.0 + liveliness * (4.0 * std::sin(0.21 * t + p1) + 2.0 * std::sin(0.5 * t + p2));
  };
  double yaw = 0.3, x = 0.0, y = 0.0;
  const auto put = [&](InertialChannel s, double value) { m.signals[s].push_back(value); };
  for (std::size_t k = 0; k < n; ++k) {
    const double t = m.grid.step * static_cast<double>(k), h = 1e-4;
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
    yaw += r * m.grid.step;
    x += v * std::cos(yaw) * m.grid.step;
    y += v * std::sin(yaw) * m.grid.step;
  }
  return m;
}

void scale(DriveMotion& m, const std::vector<InertialChannel>& signals, double factor) {
  for (const InertialChannel s : signals) {
    for (double& v : m.signals[s]) v *= factor;
  }
}

std::vector<std::string> said(const Consistency& c, const DriveMotion& m) {
  std::vector<std::string> all;
  for (const auto& faults : c.explanations)
    for (const ChannelFault& f : faults) all.push_back(f.says(m.names));
  return all;
}

std::vector<std::string> lines_of(const Consistency& c, const DriveMotion& m) {
  std::vector<std::string> lines;
  for (const auto& faults : c.explanations)
    for (const ChannelFault& f : faults)
      for (std::string& line : correction_of(f, m.names)) lines.push_back(std::move(line));
  return lines;
}

using estimation::Cause;
using ::testing::Contains;
using ::testing::HasSubstr;

TEST(Consistency, FindsNoFaultInTwoHundredCleanDrives) {
  int alarms = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const DriveMotion m = drive(seed);
    const Consistency c = check_consistency(m);
    EXPECT_GE(c.relations.size(), 7U);
    for (const auto& faults : c.explanations) {
      // The body leans and so does the road: that is in the accelerometer, and no fault.
      const bool leans = faults.size() == 1 && faults.front().cause == Cause::kMissingTerm;
      alarms += leans ? 0 : 1;
      if (!leans) ADD_FAILURE() << seed << ": " << faults.front().says(m.names);
    }
    if (c.is_off() && c.explanations.empty()) {
      ++alarms;
      for (const ChannelRelation& r : c.relations)
        if (r.outcome() != estimation::Outcome::kPassed)
          ADD_FAILURE() << seed << ": " << r.against << " " << r.low << " to " << r.high << ", correlation "
                        << r.correlation;
    }
  }
  EXPECT_EQ(alarms, 0);
}

TEST(Consistency, NamesEverySingleFaultAndTheLineThatCorrectsIt) {
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
      {"are in g, not m/s^2", {kAccelX, kAccelY, kAccelZ}, 1.0 / kGravity, "scale = 9.80665"},
      {"are in ft/s^2, not m/s^2", {kAccelX, kAccelY, kAccelZ}, 1.0 / 0.3048, "scale = 0.3048"},
      {"are in deg/s, not rad/s", {kGyroX, kGyroY, kGyroZ}, 1.0 / kDegree, "scale = 0.0174533"},
      {"are in deg, not rad", {kRoll, kPitch, kYaw}, 1.0 / kDegree, "scale = 0.0174533"},
      {"speed is in km/h, not m/s", {kSpeed}, 3.6, "speed = { channel = \"speed\", scale = 0.277778 }"},
      {"speed is in mph, not m/s", {kSpeed}, 2.2369, "speed = { channel = \"speed\", scale = 0.44704 }"},
      {"speed is in kt, not m/s", {kSpeed}, 1.94384, "speed = { channel = \"speed\", scale = 0.514444 }"},
      {"speed is in ft/s, not m/s", {kSpeed}, 3.28084, "speed = { channel = \"speed\", scale = 0.3048 }"},
      {"frd (y right, z down)", {kAccelY, kAccelZ, kGyroY, kGyroZ, kPitch, kYaw, kSteer}, -1.0, "frame = \"frd\""},
      {"the hand wheel's angle", {kSteer}, 15.0, "steering_wheel = \"steer\""},
      {"steer is in deg, not rad", {kSteer}, 1.0 / kDegree, "steer = { channel = \"steer\", scale = 0.0174533 }"},
      {"gravity in it twice", {kAccelZ}, 2.0, ""},
  };
  for (const OneFault& fault : faults) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      DriveMotion m = drive(seed);
      scale(m, fault.signals, fault.factor);
      const Consistency c = check_consistency(m);
      EXPECT_THAT(said(c, m), Contains(HasSubstr(fault.what))) << "seed " << seed;
      if (*fault.line != 0) EXPECT_THAT(lines_of(c, m), Contains(HasSubstr(fault.line))) << fault.what;
      // Nothing but the accelerometer's rest tells frd from flu: all else turns around together.
      const bool frame = std::string(fault.line).starts_with("frame") || fault.signals.front() == kAccelZ;
      EXPECT_LE(c.explanations.size(), frame ? 2U : 1U) << fault.what << ": " << testing::PrintToString(said(c, m));
    }
  }
}

TEST(Consistency, NamesBothReadingsOfASteeringThatAHeavyTruckWouldHave) {
  DriveMotion m = drive(2);
  scale(m, {kSteer}, 30.0);  // a road wheel in degrees of a short car, or a truck's hand wheel
  const Consistency c = check_consistency(m);
  EXPECT_THAT(said(c, m), Contains(HasSubstr("in deg")));
  EXPECT_THAT(said(c, m), Contains(HasSubstr("hand wheel")));
  // With the wheelbase there is one.
  const Consistency known = check_consistency(m, {.wheelbase = 2.7});
  ASSERT_EQ(known.explanations.size(), 1U) << testing::PrintToString(said(known, m));
  EXPECT_THAT(said(known, m), Contains(HasSubstr("hand wheel")));
}

TEST(Consistency, NamesAnyRatioOfTheHandWheelWhereTheWheelbaseIsKnown) {
  for (const double ratio : {4.0, 6.0, 12.0, 16.0, 22.0, 30.0}) {
    DriveMotion m = drive(3);
    scale(m, {kSteer}, ratio);
    const Consistency c = check_consistency(m, {.wheelbase = 2.7});
    ASSERT_EQ(c.explanations.size(), 1U) << ratio << testing::PrintToString(said(c, m));
    EXPECT_TRUE(c.explanations[0][0].hand_wheel) << ratio;
    EXPECT_NEAR(c.explanations[0][0].factor, ratio, 0.2 * ratio);
    EXPECT_LT(c.explanations[0][0].least, ratio);
    EXPECT_GT(c.explanations[0][0].most, ratio);
  }
  DriveMotion twice = drive(4);
  scale(twice, {kSteer}, 2.0);
  const Consistency c = check_consistency(twice, {.wheelbase = 2.7});
  ASSERT_EQ(c.explanations.size(), 1U);
  EXPECT_EQ(c.explanations[0][0].cause, Cause::kScale) << "an angle is never in knots";
}

TEST(Consistency, LeadsExchangedAxesBack) {
  DriveMotion m = drive(3);
  std::swap(m.signals[kAccelX], m.signals[kAccelY]);
  const Consistency c = check_consistency(m);
  ASSERT_EQ(c.explanations.size(), 1U) << testing::PrintToString(said(c, m));
  EXPECT_THAT(lines_of(c, m), Contains("accel_x = { channel = \"accel_y\", scale = 1 }"));
  EXPECT_THAT(lines_of(c, m), Contains("accel_y = { channel = \"accel_x\", scale = 1 }"));
  // Upward for forward.
  DriveMotion turned = drive(4);
  std::swap(turned.signals[kAccelX], turned.signals[kAccelZ]);
  const Consistency other = check_consistency(turned);
  EXPECT_THAT(lines_of(other, turned), Contains("accel_x = { channel = \"accel_z\", scale = 1 }"));
}

TEST(Consistency, NamesTwoFaultsAtOnceAndWhatIsAsLikely) {
  DriveMotion m = drive(5);
  scale(m, {kSpeed}, 3.6);
  scale(m, {kGyroX, kGyroY, kGyroZ}, 1.0 / kDegree);
  const Consistency two = check_consistency(m);
  ASSERT_EQ(two.explanations.size(), 1U) << testing::PrintToString(said(two, m));
  EXPECT_EQ(two.explanations[0].size(), 2U);
  EXPECT_THAT(said(two, m), Contains("speed is in km/h, not m/s"));
  EXPECT_THAT(said(two, m), Contains(HasSubstr("in deg/s, not rad/s")));
  // Without yaw, positions and steer nothing tells the accelerometer from the gyro.
  DriveMotion less = drive(6);
  scale(less, {kGyroZ}, -1.0);
  for (const InertialChannel c : {kYaw, kSteer, kPosX, kPosY}) less.signals[c].clear();
  EXPECT_EQ(check_consistency(less).explanations.size(), 2U);
}

TEST(Consistency, KnowsInWhichUnitAChannelWasTakenToBe) {
  DriveMotion m = drive(7);
  m.recorded_in[kSpeed] = parse_unit("mph");
  scale(m, {kSpeed}, 0.44704 * 3.6);  // numbers in km/h, read as mph
  EXPECT_THAT(said(check_consistency(m), m), Contains("speed is in km/h, not mph"));
}

TEST(Consistency, SaysNothingWhereNothingMovesAndNamesAForeignSignal) {
  const Consistency calm = check_consistency(drive(7, 0.01));
  EXPECT_TRUE(calm.explanations.empty());
  EXPECT_FALSE(calm.is_off());
  DriveMotion foreign = drive(9);
  std::mt19937 random(1);
  double held = 0.0;
  for (std::size_t k = 0; k < foreign.signals[kAccelX].size(); ++k) {
    if (k % 100 == 0) held = std::normal_distribution<double>(0.0, 2.0)(random);
    foreign.signals[kAccelX][k] = held;
  }
  const Consistency c = check_consistency(foreign);
  ASSERT_EQ(c.explanations.size(), 1U) << testing::PrintToString(said(c, foreign));
  EXPECT_THAT(said(c, foreign), Contains("accel_x shows another motion"));
}

// A fifth of what roads make, but clearly one motion.
TEST(Consistency, NamesFaultsOfLittleMotionThatTheChannelsHaveInCommon) {
  const auto little = [](unsigned seed) {
    DriveMotion m = drive(seed);
    scale(m, {kGyroZ, kSteer}, 0.05);  // r u of 0.1 m/s^2
    for (const InertialChannel c : {kYaw, kRoll, kPitch, kGyroX, kGyroY, kAccelZ, kPosX, kPosY}) m.signals[c].clear();
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0.0, 0.01);
    for (std::size_t k = 0; k < m.grid.count; ++k)
      m.signals[kAccelY][k] = m.signals[kGyroZ][k] * m.signals[kSpeed][k] + normal(random);
    return m;
  };
  DriveMotion reversed = little(11);
  scale(reversed, {kAccelY}, -1.0);
  const Consistency found = check_consistency(reversed, {.wheelbase = 2.7});
  EXPECT_THAT(said(found, reversed), Contains(HasSubstr("accel_y has the wrong sign")));
  DriveMotion exchanged = little(12);
  std::swap(exchanged.signals[kAccelX], exchanged.signals[kAccelY]);
  const Consistency axes = check_consistency(exchanged, {.wheelbase = 2.7});
  EXPECT_THAT(said(axes, exchanged), Contains(HasSubstr("exchanged")));
  const DriveMotion right = little(13);
  EXPECT_FALSE(check_consistency(right, {.wheelbase = 2.7}).is_off());
}

// No body leans by 14 deg/g: what accel_y reads too much then may as well be a yaw rate that reads too little.
TEST(Consistency, TakesNoMoreForALeanThanBodiesLean) {
  DriveMotion m = drive(14);
  scale(m, {kAccelY}, 1.25);
  for (const InertialChannel c : {kYaw, kPosX, kPosY, kSteer}) m.signals[c].clear();
  const Consistency c = check_consistency(m);
  ASSERT_GT(c.explanations.size(), 1U) << testing::PrintToString(said(c, m));
  for (const auto& faults : c.explanations) EXPECT_EQ(faults.front().cause, Cause::kScale);
}

TEST(Consistency, OfNothingThereIsNothing) {
  EXPECT_TRUE(check_consistency({}).relations.empty());
  EXPECT_TRUE(check_consistency(drive_motion(Recording{})).relations.empty());
}

TEST(MistakenUnit, StaysWithinTheDimension) {
  EXPECT_EQ(mistaken_unit(parse_unit("m/s"), 3.6), "km/h taken for m/s");
  EXPECT_EQ(mistaken_unit(parse_unit("m/s"), 1.95), "kt taken for m/s");
  EXPECT_EQ(mistaken_unit(parse_unit("m/s"), 1.1), "");
  EXPECT_EQ(mistaken_unit(parse_unit("rad"), 1.95), "");
  EXPECT_EQ(mistaken_unit(parse_unit("Pa"), 0.01), "hPa taken for Pa");
  EXPECT_EQ(mistaken_unit(parse_unit("km/h"), 1.0 / 3.6), "m/s taken for km/h");
}

}  // namespace
}  // namespace veridyn::recording
