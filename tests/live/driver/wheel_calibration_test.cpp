#include "veridyn/live/driver/wheel_calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tests/live/driver/recorded_wheel.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/files.hpp"

namespace veridyn::live {
namespace {

using testing::RecordedWheel;

DriverInput input_at(const WheelCalibration& calibration, std::initializer_list<std::pair<std::uint16_t, int>> values) {
  WheelAxes axes(calibration.at_rest());
  RecordedWheel wheel;
  for (const auto& [code, value] : values) wheel.axis(code, value);
  wheel.report();
  for (const WheelEvent& event : wheel.events) axes.take(event);
  return calibration.input(axes).value();
}

constexpr std::uint16_t kGas = 9, kBrake = 10, kMisc = 40;

TEST(WheelCalibration, OfTheSourceCoversItsNumbers) {
  const WheelCalibration calibration = source_calibration();
  EXPECT_FALSE(calibration.problem());
  EXPECT_EQ(input_at(calibration, {}), DriverInput{});
  EXPECT_NEAR(input_at(calibration, {{kAxisX, 0}}).steering, 7.854, 1e-12);
  EXPECT_NEAR(input_at(calibration, {{kAxisX, 65535}}).steering, -7.854, 1e-12);
  EXPECT_EQ(input_at(calibration, {{kGas, 150}}).throttle, 1.0);
  EXPECT_EQ(input_at(calibration, {{kBrake, 150}}).brake, 1.0);
  EXPECT_NEAR(input_at(calibration, {{kBrake, 75}}).brake, 0.5, 1e-12);
  EXPECT_FALSE(input_at(calibration, {{kMisc, 0}}).reverse);
  EXPECT_TRUE(input_at(calibration, {{kMisc, 128}}).reverse);
  // Beyond what it was calibrated for: the end.
  EXPECT_EQ(input_at(calibration, {{kGas, 255}}).throttle, 1.0);
  EXPECT_EQ(input_at(calibration, {{kGas, -5}}).throttle, 0.0);
  EXPECT_NEAR(input_at(calibration, {{kAxisX, INT32_MIN}}).steering, 7.854, 1e-12);
}

TEST(WheelCalibration, HasDeadbandsWithoutJumps) {
  WheelCalibration calibration = source_calibration();
  calibration.steering = {.axis = 0, .left = 1000, .centre = 0, .right = -2000, .lock = 10.0, .deadband = 0.1};
  calibration.throttle.deadband = 0.1;
  calibration.throttle.pressed = 1000;
  const auto steering = [&](int raw) { return input_at(calibration, {{std::uint16_t{0}, raw}}).steering; };
  const auto throttle = [&](int raw) { return input_at(calibration, {{kGas, raw}}).throttle; };
  EXPECT_EQ(steering(100), 0.0);
  EXPECT_EQ(steering(-200), 0.0);
  EXPECT_NEAR(steering(550), 5.0, 1e-12);  // half of the way from the deadband's end to the lock
  EXPECT_NEAR(steering(-1100), -5.0, 1e-12);
  EXPECT_EQ(throttle(100), 0.0);
  EXPECT_NEAR(throttle(500), 0.5, 1e-12);
  EXPECT_EQ(throttle(900), 1.0);
  for (int raw = -2100; raw < 1100; ++raw) ASSERT_LE(std::abs(steering(raw + 1) - steering(raw)), 10.0 / 900.0 + 1e-9);
  for (int raw = -100; raw < 1100; ++raw) {
    const double step = throttle(raw + 1) - throttle(raw);
    ASSERT_TRUE(step >= 0.0 && step <= 1.0 / 800.0 + 1e-9) << raw;
  }
}

TEST(WheelCalibration, TakesInvertedAndSharedAxes) {
  WheelCalibration calibration = source_calibration();
  calibration.steering = {.axis = 0, .left = 65535, .centre = 32768, .right = 0, .lock = 1.0, .deadband = 0.0};
  EXPECT_EQ(input_at(calibration, {{std::uint16_t{0}, 65535}}).steering, 1.0);
  calibration.throttle = {.axis = 5, .released = 255, .pressed = 0, .deadband = 0.0};
  EXPECT_EQ(input_at(calibration, {{std::uint16_t{5}, 0}}).throttle, 1.0);
  EXPECT_EQ(input_at(calibration, {{std::uint16_t{5}, 255}}).throttle, 0.0);
  // One axis for both pedals, at rest in the middle.
  calibration.throttle = {.axis = 5, .released = 128, .pressed = 0, .deadband = 0.0};
  calibration.brake = {.axis = 5, .released = 128, .pressed = 255, .deadband = 0.0};
  EXPECT_FALSE(calibration.problem());
  const DriverInput braking = input_at(calibration, {{std::uint16_t{5}, 255}});
  EXPECT_EQ(braking.brake, 1.0);
  EXPECT_EQ(braking.throttle, 0.0);
}

TEST(WheelCalibration, SaysNothingBeforeEveryAxisWasHeardOf) {
  const WheelCalibration calibration = source_calibration();
  WheelAxes axes;
  RecordedWheel wheel;
  wheel.axis(kAxisX, 0).axis(kGas, 0).axis(kMisc, 0).report();
  for (const WheelEvent& event : wheel.events) axes.take(event);
  EXPECT_FALSE(calibration.input(axes));
  RecordedWheel().axis(kBrake, 0).report().play([&](const WheelEvent& event) { axes.take(event); });
  EXPECT_TRUE(calibration.input(axes));
}

class CalibrationFile {
 public:
  [[nodiscard]] WheelCalibration read(const std::string& text) const {
    write_file(path_, text);
    return WheelCalibration::load(path_);
  }
  [[nodiscard]] std::string refusal(const std::string& text) const {
    const std::string message = why([&] { (void)read(text); });
    return message.substr(message.rfind('/') + 1);
  }

 private:
  veridyn::test::TemporaryFolder folder_;
  std::string path_ = (folder_.path() / "wheel.toml").string();
};

TEST(WheelCalibration, IsWrittenAndReadAgain) {
  const CalibrationFile file;
  WheelCalibration calibration = source_calibration();
  calibration.clutch = PedalCalibration{.axis = 33, .released = 255, .pressed = -3, .deadband = 0.015};
  calibration.steering.lock = 0.1 + 0.2;
  const WheelCalibration again = file.read(calibration.to_toml());
  EXPECT_EQ(again.to_toml(), calibration.to_toml());
  EXPECT_EQ(again.steering.lock, calibration.steering.lock);
  ASSERT_TRUE(again.clutch && again.gear);
  EXPECT_EQ(again.clutch->axis, 33);
  EXPECT_EQ(again.clutch->pressed, -3);
  EXPECT_EQ(again.gear->reverse, 128);
  // By hand, with a unit.
  const WheelCalibration by_hand = file.read(
      "[steering]\naxis = \"ABS_WHEEL\"\nleft = 0\ncentre = 500\nright = 1023\nlock = \"450 deg\"\n[throttle]\n"
      "axis = \"ABS_GAS\"\nreleased = 0\npressed = 255\n[brake]\naxis = \"ABS_BRAKE\"\nreleased = 0\npressed = 255\n");
  EXPECT_NEAR(by_hand.steering.lock, 2.5 * kPi, 1e-12);
  EXPECT_FALSE(by_hand.clutch);
  EXPECT_FALSE(by_hand.gear);
}

TEST(WheelCalibration, ThatCannotBeIsRefusedWithFileLineAndKey) {
  const CalibrationFile file;
  const std::string good = source_calibration().to_toml();
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    return file.refusal(text);
  };
  EXPECT_EQ(with("centre = 32768", "centre = 70000"),
            "wheel.toml:5: steering.centre: is 70000; must lie between the locks 0 "
            "and 65535");
  EXPECT_EQ(with("axis = \"ABS_X\"", "axis = \"ABS_Q\""),
            "wheel.toml:3: steering.axis: 'ABS_Q' is no axis; say ABS_X, ABS_WHEEL, "
            "ABS_GAS, ... or ABS_ "
            "and its number");
  EXPECT_EQ(with("lock = 7.854", "lock = -1"),
            "wheel.toml:7: steering.lock: = -1 rad must be above 0 and at most 100 rad");
  EXPECT_EQ(with("deadband = 0.005", "deadband = 0.9"), "wheel.toml:8: steering.deadband: = 0.9 must be from 0 to 0.5");
  EXPECT_EQ(with("pressed = 150", "pressed = 0"),
            "wheel.toml:12: throttle.pressed: is 0, where the pedal is released: it "
            "does not move");
  EXPECT_EQ(with("ABS_BRAKE", "ABS_GAS"),
            "wheel.toml:15: brake.axis: ABS_GAS is that of the throttle too, and "
            "their ranges overlap");
  EXPECT_EQ(with("ABS_BRAKE", "ABS_X"), "wheel.toml:15: brake.axis: ABS_X is that of the steering");
  EXPECT_EQ(with("ABS_MISC", "ABS_GAS"), "wheel.toml:20: gear.axis: ABS_GAS is that of the steering or a pedal");
  EXPECT_EQ(with("reverse = 128", "reverse = 0"), "wheel.toml:22: gear.reverse: is 0 like forward");
  EXPECT_EQ(with("left = 0", "left = 3000000000"),
            "wheel.toml:4: steering.left: is 3000000000, beyond what an axis can say");
  EXPECT_NE(with("[brake]", "[brakes]").find("brake"), std::string::npos);
  EXPECT_NE(with("left = 0", "left = 0\nleft_lock = 3").find("left_lock"), std::string::npos);
}

}  // namespace
}  // namespace veridyn::live
