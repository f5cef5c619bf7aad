#include "veridyn/live/telemetry/spike_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace veridyn::live {
namespace {

const Eigen::Vector3d kRest(0.0, 0.0, 9.8);

TEST(SpikeFilter, LeavesWhatChangesSlowlyAsItIs) {
  SpikeFilter filter(500.0);
  for (int k = 0; k < 1000; ++k) {
    const Eigen::Vector3d v = kRest + Eigen::Vector3d(8.0 * std::sin(0.6 * k), 0.0, 0.0);  // 480 m/s^3 at 100 Hz
    EXPECT_EQ(filter.step(v, 0.01), v);
  }
}

TEST(SpikeFilter, TakesALandingOffAndDelaysALastingChangeByNoMoreThanItsBound) {
  SpikeFilter filter(500.0);
  filter.step(kRest, 0.01);
  // +39 m/s^2 for one packet of 16 ms: 8 m/s^2 pass.
  EXPECT_NEAR(filter.step(kRest + Eigen::Vector3d(0.0, 0.0, 39.0), 0.016).z(), 17.8, 1e-12);
  EXPECT_EQ(filter.step(kRest, 0.016), kRest);
  // Braking at once with 10 m/s^2 is there after 20 ms.
  const Eigen::Vector3d brakes = kRest - Eigen::Vector3d(10.0, 0.0, 0.0);
  EXPECT_NE(filter.step(brakes, 0.0199), brakes);
  EXPECT_EQ(filter.step(brakes, 0.0002), brakes);
}

TEST(SpikeFilter, StandsWhatIsNoNumberAndTimesThatAreNone) {
  SpikeFilter filter(500.0);
  const Eigen::Vector3d first = filter.step(kRest, 0.01);
  EXPECT_EQ(filter.step({std::nan(""), 0.0, 0.0}, 0.01), first);
  EXPECT_EQ(filter.step(Eigen::Vector3d::Zero(), -1.0), first);
  EXPECT_EQ(filter.step(Eigen::Vector3d::Zero(), std::nan("")), first);
  filter.reset();
  EXPECT_EQ(filter.step(Eigen::Vector3d::Zero(), 0.01), Eigen::Vector3d::Zero());
  SpikeFilter open(std::numeric_limits<double>::infinity());
  open.step(kRest, 0.01);
  EXPECT_EQ(open.step(100.0 * kRest, 0.01), 100.0 * kRest);
}

}  // namespace
}  // namespace veridyn::live
