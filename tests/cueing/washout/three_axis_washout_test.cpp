#include "veridyn/cueing/washout/three_axis_washout.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/cueing/washout/pushed.hpp"
#include "tests/support/refusal.hpp"

namespace veridyn::cueing {
namespace {

using testing_support::pushed;

/// The command after so many seconds of a motion that begins with the run's second step.
PlatformCommand after(double seconds, const recording::MotionSample& sample, const ThreeAxisDesign& design) {
  ThreeAxisWashout w(design);
  PlatformCommand command = w.reset(pushed(0.0));
  const long steps = std::lround(seconds / 0.005);
  for (long k = 0; k < steps; ++k) command = w.step(sample, 0.005);
  return command;
}

// The onset is gone, and gravity stands for gain times the force.
TEST(ThreeAxisWashout, EndsInTheTiltOfALastingForce) {
  ThreeAxisDesign design;
  const double f = design.sustained * design.shared.force_gain[0] * 1.0;
  EXPECT_NEAR(after(30.0, pushed(1.0), design).angle.y(), std::asin(f / kGravity), 1e-5);
}

// What distinguishes it from the classical algorithm: a share of the force is there in the first tenths of a second.
TEST(ThreeAxisWashout, BeginsAForceByATiltOfItsOwn) {
  ThreeAxisDesign without;
  without.instant = 0.0;
  const double onset = after(0.3, pushed(1.0), {}).angle.y(), slope = after(0.3, pushed(1.0), without).angle.y();
  EXPECT_GT(onset, 1.2 * slope);
  EXPECT_NEAR(after(30.0, pushed(1.0), without).angle.y(), after(30.0, pushed(1.0), {}).angle.y(), 1e-5)
      << "which does not last";
  // Neither channel turns faster than it may, so both together no faster than the sum.
  ThreeAxisDesign design;
  ThreeAxisWashout w(design);
  double before = w.reset(pushed(0.0)).angle.y();
  for (int k = 0; k < 400; ++k) {
    const double now = w.step(pushed(8.0), 0.005).angle.y();
    EXPECT_LE(std::abs(now - before) / 0.005, design.onset_rate + design.shared.tilt_rate + 1e-9);
    before = now;
  }
}

TEST(ThreeAxisWashout, BoundsHardHits) {
  ThreeAxisDesign design;
  design.bound = {2.0, 2.0, 2.0};
  const PlatformCommand at_bound = after(1.0, pushed(2.0 / design.shared.force_gain[0]), design);
  const PlatformCommand beyond = after(1.0, pushed(50.0), design);
  // The lead-in of the run's beginning is over in both: they began at rest.
  EXPECT_NEAR(beyond.angle.y(), at_bound.angle.y(), 1e-9);
}

TEST(ThreeAxisWashout, NeitherSurgesNorSways) {
  const PlatformCommand command = after(0.5, pushed(3.0), {});
  EXPECT_EQ(command.shift.head<2>(), Eigen::Vector2d::Zero());
}

TEST(ThreeAxisWashout, RefusesAKnobThatIsNone) {
  ThreeAxisDesign design;
  design.heave_jerk = -1.0;
  EXPECT_NE(why([&] { ThreeAxisWashout{design}; }).find("heave_jerk"), std::string::npos);
}

}  // namespace
}  // namespace veridyn::cueing
