#include "veridyn/cueing/score/frequency_response.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "veridyn/cueing/washout/washout_design.hpp"

namespace veridyn::cueing {
namespace {

TEST(FrequencyResponse, OfTheClassicalAlgorithmOnTheIdealPlatformIsItsFilters) {
  // Of yaw: 0.6 s^2 / (s + 1)^2; what of it the guard changes is below a hundredth.
  const Platform& ideal = built_in_platform("ideal");
  Progress progress;
  ResponseOptions options;
  options.frequencies = {0.5, 1.0, 3.0};
  const auto points =
      frequency_response(*washout_algorithm("classical").design()->make(ideal), ideal, Cue::kYaw, options, progress);
  ASSERT_EQ(points.size(), 3u);
  for (const ResponsePoint& p : points) {
    const std::complex<double> s(0.0, p.frequency), exact = 0.6 * s * s / ((s + 1.0) * (s + 1.0));
    EXPECT_LT(std::abs(std::polar(p.gain, p.phase) - exact), 0.01) << p.frequency;
  }
}

TEST(FrequencyResponse, OfTheWholeChainHasTheActuatorsDelay) {
  Platform slow = built_in_platform("ideal");
  slow.actuators = {.omega = 20.0, .zeta = 1.0, .delay = 0.05};
  Progress progress;
  ResponseOptions options;
  options.frequencies = {2.0};
  const auto washout = washout_algorithm("classical").design()->make(slow);
  const auto with = frequency_response(*washout, slow, Cue::kYaw, options, progress),
             without = frequency_response(*washout, built_in_platform("ideal"), Cue::kYaw, options, progress);
  const std::complex<double> s(0.0, 2.0);
  const std::complex<double> actuator = 400.0 / ((s + 20.0) * (s + 20.0)) * std::exp(-s * 0.05);
  const std::complex<double> ratio =
      std::polar(with[0].gain, with[0].phase) / std::polar(without[0].gain, without[0].phase);
  EXPECT_LT(std::abs(ratio - actuator), 2e-3);
}

TEST(Mask, NamesThePointsOutsideIt) {
  const std::vector<ResponsePoint> response = {{0.1, 0.9, 0.0}, {1.0, 0.4, -1.0}, {10.0, 0.05, -2.0}, {20.0, 9.0, 0.0}};
  const std::vector<MaskPoint> mask = {{.frequency = 0.1, .least_gain = 0.8, .most_gain = 1.0},
                                       {.frequency = 10.0, .least_gain = 0.0, .most_gain = 1.0}};
  const auto found = outside(response, mask);
  ASSERT_EQ(found.size(), 1u);  // at 1 rad/s: 0.4 is below 0.8 (1 - 0.9/9.9); beyond 10 rad/s there is no limit
  EXPECT_EQ(found[0].frequency, 1.0);
}

}  // namespace
}  // namespace veridyn::cueing
