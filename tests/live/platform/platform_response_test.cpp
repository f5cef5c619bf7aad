#include "veridyn/live/platform/platform_response.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/cueing/platform/platform_guard.hpp"
#include "veridyn/cueing/platform/platform_simulator.hpp"
#include "veridyn/live/platform/test_signal.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::live {
namespace {

using cueing::PlatformAxis;
using ::testing::HasSubstr;

/// A sweep on the platform simulator, which is stepped ten times as fast as orders come, with noise of its encoders.
ToldAndReached swept(const cueing::Platform& platform, PlatformAxis axis, double noise) {
  cueing::PlatformGuard guard(platform.limits);
  cueing::PlatformSimulator simulator(platform);
  numerics::RandomStream random(1, "encoders");
  TestSignalOptions signal;
  signal.duration = 30.0;
  ToldAndReached m;
  m.step = 0.01;
  for (int k = 0; k * m.step < signal.duration; ++k) {
    cueing::PlatformState to;
    set_axis(
        to, axis,
        {.position = wanted_position(signal, platform.limits[axis], k * m.step), .rate = 0.0, .acceleration = 0.0});
    const cueing::PlatformState ordered = guard.step(to, k == 0 ? 0.0 : m.step);
    m.ordered.push_back(cueing::axis(ordered, axis).position);
    m.reached.push_back(cueing::axis(simulator.step(ordered, k == 0 ? 0.0 : m.step), axis).position +
                        noise * random.normal());
  }
  return m;
}

TEST(PlatformResponse, FindsTheActuatorsOfASimulatedPlatform) {
  for (const auto& [omega, zeta, delay] :
       {std::tuple(30.0, 1.0, 0.01), std::tuple(12.0, 0.5, 0.05), std::tuple(60.0, 0.7, 0.1)}) {
    cueing::Platform platform = cueing::built_in_platform("three_axis");
    platform.legs.reset();
    platform.actuators = {.omega = omega, .zeta = zeta, .delay = delay};
    const PlatformResponse r = fit_response(swept(platform, PlatformAxis::kPitch, 2e-4));
    EXPECT_NEAR(r.gain.value, 1.0, 0.01) << omega;
    EXPECT_NEAR(r.omega.value, omega, 0.06 * omega);
    EXPECT_NEAR(r.zeta.value, zeta, 0.06 * zeta);
    // A held order is half a step late, which the simulator's filters know of and the fit's too.
    EXPECT_NEAR(r.delay.value, delay, 4e-3) << omega;
    EXPECT_LT(r.rms, 0.02);
    EXPECT_THAT(r.notes, ::testing::IsEmpty());
  }
}

TEST(PlatformResponse, StandardErrorsAreThoseOfManyFits) {
  cueing::Platform platform = cueing::built_in_platform("three_axis");
  platform.legs.reset();
  ToldAndReached clean = swept(platform, PlatformAxis::kPitch, 0.0);
  numerics::RandomStream random(2, "encoders");
  double sum = 0.0, squares = 0.0, sigma = 0.0;
  constexpr int kFits = 40;
  for (int k = 0; k < kFits; ++k) {
    ToldAndReached m = clean;
    for (double& v : m.reached) v += 1e-3 * random.normal();
    const PlatformResponse r = fit_response(m);
    sum += r.omega.value;
    squares += r.omega.value * r.omega.value;
    sigma += r.omega.sigma / kFits;
  }
  const double scatter = std::sqrt((squares - sum * sum / kFits) / (kFits - 1));
  EXPECT_NEAR(sigma / scatter, 1.0, 0.35);  // of 40 fits the scatter is known to 11 %
}

TEST(PlatformResponse, SeesWhereAPlatformReachesLess) {
  const cueing::Platform& platform = cueing::built_in_platform("three_axis");
  ToldAndReached m = swept(platform, PlatformAxis::kRoll, 0.0);
  for (double& v : m.reached) v *= 0.9;
  const PlatformResponse r = fit_response(m);
  EXPECT_NEAR(r.gain.value, 0.9, 0.01);
  EXPECT_THAT(r.notes, ::testing::Contains(HasSubstr("it reaches 90 % of what is commanded")));
  for (double& v : m.reached) v *= -1.0;
  EXPECT_THAT(fit_response(m).notes, ::testing::Contains(HasSubstr("wrong sign")));
}

TEST(PlatformResponse, RefusesWhatSaysNothing) {
  ToldAndReached m;
  EXPECT_THAT(why([&] { static_cast<void>(fit_response(m)); }), HasSubstr("0 answers; takes 200 at least"));
  m.ordered.assign(300, 0.0);
  m.reached.assign(300, 0.0);
  EXPECT_THAT(why([&] { static_cast<void>(fit_response(m)); }), HasSubstr("had no order"));
  for (std::size_t k = 0; k < 300; ++k) m.ordered[k] = 0.1 * std::sin(0.1 * static_cast<double>(k));
  EXPECT_THAT(why([&] { static_cast<void>(fit_response(m)); }), HasSubstr("does not move"));
  m.reached[7] = kNaN;
  EXPECT_THAT(why([&] { static_cast<void>(fit_response(m)); }), HasSubstr("not finite"));
}

}  // namespace
}  // namespace veridyn::live
