#include "veridyn/live/driver/guided_calibration.hpp"

#include <gtest/gtest.h>

#include "tests/live/driver/recorded_wheel.hpp"
#include "tests/support/refusal.hpp"

namespace veridyn::live {
namespace {

using testing::RecordedWheel;

/// A wheel on ABS_X, pedals on ABS_Z and ABS_RZ that are 255 when released.
class Driver {
 public:
  explicit Driver(std::vector<WheelAxis> axes = {{.code = 0, .lowest = 0, .highest = 65535, .value = 32000},
                                                 {.code = 2, .lowest = 0, .highest = 255, .value = 255},
                                                 {.code = 5, .lowest = 0, .highest = 255, .value = 255}})
      : calibration(axes, 7.8) {}

  /// Moves an axis, a jittery number of events on the way, and confirms. Empty: on to the next step.
  std::string does(std::uint16_t code, int value) {
    RecordedWheel().axis(code, value / 2).report().axis(code, value).report().play([&](const WheelEvent& event) {
      calibration.take(event);
    });
    return calibration.confirm().value_or("");
  }
  std::string confirms() { return calibration.confirm().value_or(""); }

  GuidedCalibration calibration;
};

TEST(GuidedCalibration, FindsAxesEndsAndDirections) {
  Driver driver;
  EXPECT_EQ(driver.calibration.prompt(),
            "Press each pedal once and release it; let the wheel stand straight, hands off; then confirm.");
  EXPECT_EQ(driver.confirms(), "");
  EXPECT_EQ(driver.calibration.prompt(), "Turn the wheel fully to the left, hold it there and confirm.");
  EXPECT_EQ(driver.does(0, 300), "");
  EXPECT_EQ(driver.does(0, 65000), "");
  EXPECT_EQ(driver.does(0, 33000), "");
  EXPECT_EQ(driver.calibration.step(), CalibrationStep::kThrottleDown);
  EXPECT_EQ(driver.does(5, 10), "");
  EXPECT_EQ(driver.does(5, 250), "");
  EXPECT_EQ(driver.does(2, 0), "");
  EXPECT_EQ(why([&] { (void)driver.calibration.calibration(); }),
            "calibration: not complete; next: Release the brake and confirm.");
  EXPECT_EQ(driver.does(2, 255), "");
  EXPECT_EQ(driver.calibration.step(), CalibrationStep::kDone);
  EXPECT_EQ(driver.calibration.prompt(), "Done.");
  EXPECT_EQ(driver.confirms(), "");

  const WheelCalibration found = driver.calibration.calibration();
  EXPECT_EQ(found.steering.axis, 0);
  EXPECT_EQ(found.steering.left, 300);
  EXPECT_EQ(found.steering.right, 65000);
  EXPECT_EQ(found.steering.centre, 32500);  // between where it stood at first and in the end
  EXPECT_EQ(found.steering.lock, 7.8);
  EXPECT_EQ(found.throttle.axis, 5);
  EXPECT_EQ(found.throttle.pressed, 10);
  EXPECT_EQ(found.throttle.released, 250);
  EXPECT_EQ(found.brake.axis, 2);
  EXPECT_EQ(found.brake.pressed, 0);
  EXPECT_EQ(found.brake.released, 255);
  EXPECT_FALSE(found.problem());
}

TEST(GuidedCalibration, SaysWhatIsWrongAndAsksAgain) {
  Driver driver;
  EXPECT_EQ(driver.confirms(), "");
  EXPECT_EQ(driver.confirms(), "wheel: no axis moved by a tenth of its range");
  EXPECT_EQ(driver.does(0, 30000), "wheel: no axis moved by a tenth of its range");
  (void)driver.does(2, 100);
  EXPECT_EQ(driver.calibration.step(), CalibrationStep::kRight);  // a pedal was taken for the wheel: one step back
  driver.calibration.back();
  EXPECT_EQ(driver.does(0, 300), "wheel: two axes moved, ABS_Z and ABS_X; move one thing only");
  RecordedWheel().axis(2, 255).report().play([&](const WheelEvent& event) { driver.calibration.take(event); });
  EXPECT_EQ(driver.confirms(), "");

  EXPECT_EQ(driver.confirms(),
            "wheel: it turned the wrong way: axis ABS_X is at 300, on the left of the middle like 300");
  EXPECT_EQ(driver.does(0, 33000), "wheel: axis ABS_X is not a tenth of its range away from the middle");
  EXPECT_EQ(
      driver.does(0, 45000),
      "wheel: one lock is more than twice as far from the middle (32000) as the other: 300 and 45000; turn it fully, "
      "or begin again with the wheel straight");
  EXPECT_EQ(driver.does(0, 65535), "");
  EXPECT_EQ(driver.does(0, 40000),
            "wheel: it does not stand straight: axis ABS_X is at 40000, and was at 32000 at first");
  EXPECT_EQ(driver.does(0, 32100), "");

  EXPECT_EQ(driver.confirms(), "throttle: no axis moved by a tenth of its range");
  EXPECT_EQ(driver.does(0, 65535), "throttle: the wheel moved (axis ABS_X), not a pedal");
  EXPECT_EQ(driver.does(0, 32000), "throttle: no axis moved by a tenth of its range");
  EXPECT_EQ(driver.does(5, 0), "");
  EXPECT_EQ(driver.does(5, 128), "throttle: it is not released: axis ABS_RZ is at 128, and was at 255 at first");
  EXPECT_EQ(driver.does(5, 255), "");
  EXPECT_EQ(driver.does(5, 5),
            "brake: axis ABS_RZ moves as for the throttle, to 5: their ranges overlap; press the other pedal");
  RecordedWheel().axis(5, 255).report().play([&](const WheelEvent& event) { driver.calibration.take(event); });
  EXPECT_EQ(driver.does(2, 0), "");
  EXPECT_EQ(driver.does(2, 255), "");
  EXPECT_EQ(driver.calibration.step(), CalibrationStep::kDone);
}

TEST(GuidedCalibration, TakesPedalsThatShareAnAxis) {
  Driver driver({{.code = 8, .lowest = -512, .highest = 511, .value = 3},
                 {.code = 1, .lowest = 0, .highest = 255, .value = 128}});
  EXPECT_EQ(driver.confirms(), "");
  EXPECT_EQ(driver.does(8, 511), "");  // an inverted wheel
  EXPECT_EQ(driver.does(8, -512), "");
  EXPECT_EQ(driver.does(8, 0), "");
  EXPECT_EQ(driver.does(1, 0), "");
  EXPECT_EQ(driver.does(1, 130), "");
  EXPECT_EQ(driver.does(1, 255), "");
  EXPECT_EQ(driver.does(1, 126), "");
  const WheelCalibration found = driver.calibration.calibration();
  EXPECT_FALSE(found.problem());
  EXPECT_EQ(found.throttle.released, 128);
  EXPECT_EQ(found.brake.released, 128);
  EXPECT_EQ(found.steering.left, 511);
}

TEST(GuidedCalibration, NeedsAxesWithARangeAndALock) {
  const WheelAxis x{.code = 0, .lowest = 0, .highest = 255}, none{.code = 2, .lowest = 1, .highest = 1},
      z{.code = 2, .lowest = 0, .highest = 255};
  const auto refusal = [](std::vector<WheelAxis> axes, double lock) {
    return why([&] { GuidedCalibration calibration(axes, lock); });
  };
  EXPECT_EQ(refusal({x}, 1.0), "calibration: a wheel with pedals has two axes or more");
  EXPECT_EQ(refusal({x, none}, 1.0), "calibration: axis ABS_Z has no range: 1 to 1");
  EXPECT_EQ(refusal({x, z}, 0.0), "calibration: the lock of 0 rad must be > 0 and <= 100");
}

}  // namespace
}  // namespace veridyn::live
