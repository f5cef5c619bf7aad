#include "veridyn/vehicle/identification/signals/drive_signals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/vehicle/changed_drive.hpp"

namespace veridyn::vehicle {
namespace {

using testing::changed;
using testing::prepared;
using testing::recorded;
using testing::without;

TEST(DriveSignals, NamesWhatIsMissing) {
  const Recording r = recorded();
  EXPECT_NE(why([&] { prepared(without(r, "steer")); }).find("has no steer"), std::string::npos);
  EXPECT_NE(why([&] { prepared(without(r, "speed")); }).find("has no speed"), std::string::npos);
  EXPECT_NE(why([&] { prepared(without(r, "yaw_rate")); }).find("has no yaw_rate"), std::string::npos);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(why([&] {
              prepared(changed(r, "yaw_rate", [&](double, double) { return nan; }));
            }).find("holds no numeric values"),
            std::string::npos);
  EXPECT_NE(why([&] { prepared(Recording{}); }), "");
}

TEST(DriveSignals, TakesTheHandWheelAndWheelSpeeds) {
  const Recording r = recorded();
  Recording other = recording::without_channels(r);
  other.add(r.at("yaw_rate"));
  other.add(r.at("accel_y"));
  Channel wheel = r.at("steer");
  wheel.name = "steering_wheel";
  for (double& v : wheel.value) v *= 16.0;
  other.add(wheel);
  for (const char* name : {"wheel_speed_rl", "wheel_speed_rr"}) {
    const Channel& u = r.at("speed");
    std::vector<double> omega = u.value;
    for (double& v : omega) v /= 0.3;
    other.add(make_channel(name, "rad/s", u.time, omega));
  }
  EXPECT_NE(why([&] { prepared(other); }).find("signals.steering_ratio"), std::string::npos);
  EXPECT_NE(why([&] { prepared(other, {.steering_ratio = 16.0}); }).find("signals.rolling_radius"), std::string::npos);
  const DriveSignals a = prepared(r), b = prepared(other, {.steering_ratio = 16.0, .rolling_radius = 0.3});
  for (std::size_t k = 0; k < a.size(); k += 100) {
    EXPECT_NEAR(a[DriveSignal::kSteer].value[k], b[DriveSignal::kSteer].value[k], 1e-12);
    EXPECT_NEAR(a[DriveSignal::kSpeed].value[k], b[DriveSignal::kSpeed].value[k], 1e-9);
  }
}

TEST(DriveSignals, TakesSpeedFromTheTreadsOfTheWheels) {
  const Recording r = recorded();
  const Channel& u = r.at("speed");
  Recording treads = without(r, "speed");
  for (const auto& [name, more] : {std::pair("wheel_velocity_rl", 0.5), std::pair("wheel_velocity_rr", -0.5)}) {
    std::vector<double> velocity = u.value;
    for (double& v : velocity) v += more;
    treads.add(make_channel(name, "m/s", u.time, velocity));
  }
  const DriveSignals a = prepared(r), b = prepared(treads);
  for (std::size_t k = 0; k < a.size(); k += 100)
    EXPECT_NEAR(a[DriveSignal::kSpeed].value[k], b[DriveSignal::kSpeed].value[k], 1e-9);
}

TEST(DriveSignals, TakesGravityOffByRollOrByItsGradient) {
  const Recording r = recorded();
  const double gradient = 0.0089, g = 9.80665;
  // A body that leans outward in proportion: left side up in a left turn.
  const Channel& a = r.at("accel_y");
  std::vector<double> roll(a.value), felt(a.value);
  for (std::size_t i = 0; i < roll.size(); ++i) {
    roll[i] = gradient * a.value[i];
    felt[i] = a.value[i] + g * std::sin(roll[i]);
  }
  Recording leaning = r;
  leaning.set(make_channel("accel_y", "m/s^2", a.time, felt));
  const DriveSignals by_gradient = prepared(leaning, {.roll_gradient = gradient});
  leaning.add(make_channel("roll", "rad", a.time, roll));
  const DriveSignals by_roll = prepared(leaning);
  EXPECT_TRUE(by_gradient.gravity_removed);
  for (std::size_t k = 0; k < by_roll.size(); k += 50) {
    EXPECT_NEAR(by_roll[DriveSignal::kAccelY].value[k], a.value[k], 1e-9);
    EXPECT_NEAR(by_gradient[DriveSignal::kAccelY].value[k], a.value[k], 1e-3);
  }
}

}  // namespace
}  // namespace veridyn::vehicle
