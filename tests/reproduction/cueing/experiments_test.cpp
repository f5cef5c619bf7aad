#include "bench/reproduction/cueing/experiments.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::cueing {
namespace {

double largest_of(const std::vector<double>& values) {
  double most = 0.0;
  for (const double v : values) most = std::max(most, std::abs(v));
  return most;
}

TEST(Experiments, TheRampGoesUpAndDownAndItsCommandsMirror) {
  const Experiment pitch = ramp(PlatformAxis::kPitch), roll = ramp(PlatformAxis::kRoll);
  for (const Experiment* e : {&pitch, &roll}) {
    EXPECT_NEAR(*std::max_element(e->curves[0].values.begin(), e->curves[0].values.end()), 30.0 * kDegree, 1e-9);
    EXPECT_NEAR(*std::min_element(e->curves[0].values.begin(), e->curves[0].values.end()), -30.0 * kDegree, 1e-9);
    // On the ramp itself, long enough, tilt stands for all of the slope, and nothing is left at the end.
    EXPECT_NEAR(e->curves[1].values[790], 30.0 * kDegree, 3.0 * kDegree);
    EXPECT_NEAR(e->curves[2].values[790], 60.0 * kDegree, 0.1 * kDegree);
    EXPECT_NEAR(e->curves[1].values.back(), 0.0, 3.0 * kDegree);
    EXPECT_NEAR(e->curves[2].values.back(), 0.0, 1e-6);
  }
}

TEST(Experiments, TheCameraTakesTheFalsePitchAway) {
  const Experiment e = level_track();
  EXPECT_GT(largest_of(e.curves[0].values), 5.0 * kDegree);
  EXPECT_LT(largest_of(e.curves[1].values), 0.5 * kDegree);
}

TEST(Experiments, AMeasuredPlatformStopsShort) {
  EXPECT_NEAR(reached(PlatformAxis::kPitch, 20.0 * kDegree), 18.5 * kDegree, 1e-6);
  EXPECT_LT(held_tilt(PlatformAxis::kPitch, 3.0), std::asin(3.0 / kGravity));
}

}  // namespace
}  // namespace veridyn::cueing
