#include "veridyn/aircraft/identification/signals/air_rates.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

constexpr double kAirspeed = 30.0, kGridStep_s = 0.01;
constexpr std::size_t kCount = 3000, kMiddle = kCount / 2;
/// Ten seconds long: waves of 300 m, much longer than any aircraft here.
constexpr double kOmega = 2.0 * kPi / 10.0;

Channel along(const char* name, const char* unit, const std::function<double(double)>& of) {
  std::vector<double> time, value;
  for (std::size_t k = 0; k < kCount; ++k) {
    time.push_back(static_cast<double>(k) * kGridStep_s);
    value.push_back(of(time.back()));
  }
  return make_channel(name, unit, make_time_base(std::move(time)), std::move(value));
}

AirRates rates_of(const std::function<double(double)>& v, const std::function<double(double)>& w,
                  const std::function<double(double)>& alpha) {
  Recording smoothed;
  smoothed.add(along("gust_y", "m/s", v));
  smoothed.add(along("gust_z", "m/s", w));
  smoothed.add(along("alpha", "rad", alpha));
  const numerics::UniformGrid grid{0.0, kGridStep_s, kCount};
  const numerics::FirKernel smooth = numerics::low_pass({.rate_Hz = 100.0, .pass_Hz = 10.0, .stop_Hz = 20.0});
  return air_rates(smoothed, grid, std::vector<double>(kCount, kAirspeed), smooth, builtin_subject("thor"));
}

double wave(double t) { return std::sin(kOmega * t); }
double none(double) { return 0.0; }

/// Of a wave, at `kMiddle`.
double slope() { return kOmega * std::cos(kOmega * static_cast<double>(kMiddle) * kGridStep_s) / kAirspeed; }

// The nose meets a gust along z first, which acts as a pitch rate does: q turns a point x ahead by -q x along z.
TEST(AirRates, OfLongGustsAreTheirSlopesAlongThePath) {
  const AirRates rates = rates_of(wave, wave, none);
  EXPECT_NEAR(rates.gust_q[kMiddle], slope(), 0.05 * std::abs(slope()));
  EXPECT_NEAR(rates.gust_r[kMiddle], -slope(), 0.05 * std::abs(slope()));
}

TEST(AirRates, OfShortGustsDoNotTurnTheWholeAircraft) {
  const auto fast = [](double t) { return std::sin(20.0 * kOmega * t); };
  const AirRates rates = rates_of(none, fast, none);
  double largest = 0.0;
  for (const double q : rates.gust_q) largest = std::max(largest, std::abs(q));
  EXPECT_LT(largest, 0.95 * 20.0 * kOmega / kAirspeed);
  EXPECT_GT(largest, 0.3 * 20.0 * kOmega / kAirspeed);
}

// alpha by a gust alone, -w/V: in still air nothing would have changed, so all of alpha' is late downwash.
TEST(AirRates, DownwashFollowsTheGustsThatTheAircraftFliesInto) {
  const AirRates own = rates_of(none, none, wave);
  const AirRates by_gust = rates_of(
      none, [](double t) { return -kAirspeed * wave(t); }, wave);
  EXPECT_NEAR(own.downwash_q[kMiddle], 0.0, 0.05 * kAirspeed * std::abs(slope()));
  EXPECT_NEAR(by_gust.downwash_q[kMiddle], kAirspeed * slope(), 0.05 * kAirspeed * std::abs(slope()));
}

TEST(AirRates, AreAddedByTheirShares) {
  AirRates rates = rates_of(wave, wave, wave);
  FlightSample<double> sample;
  sample[FlightSignal::kQ] = 0.1;
  sample[FlightSignal::kR] = 0.2;
  EXPECT_EQ(rates.against_air(sample, kMiddle)[FlightSignal::kQ], 0.1);
  rates.pitch_share = 0.5;
  rates.yaw_share = -2.0;
  EXPECT_DOUBLE_EQ(rates.against_air(sample, kMiddle)[FlightSignal::kQ], 0.1 + 0.5 * rates.gust_q[kMiddle]);
  EXPECT_DOUBLE_EQ(rates.against_air(sample, kMiddle)[FlightSignal::kR], 0.2 - 2.0 * rates.gust_r[kMiddle]);
}

TEST(AirRates, ErrorsOfRollAreNoLessThanNone) {
  AirRates rates{.answered_roll = 0.01};
  rates.roll_share = 0.5;
  EXPECT_DOUBLE_EQ(rates.error_of_roll(), 0.005);
  rates.roll_share = -0.1;
  EXPECT_EQ(rates.error_of_roll(), 0.0);
}

}  // namespace
}  // namespace veridyn::aircraft
