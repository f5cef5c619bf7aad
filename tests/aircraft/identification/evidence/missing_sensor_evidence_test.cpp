#include "veridyn/aircraft/identification/evidence/missing_sensor_evidence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Check;
using estimation::Evidence;
using estimation::Outcome;

/// A minute at 20 m/s; alpha moves by 2 deg root mean square.
struct UnfeltFlight {
  Recording recording;
  Reconstruction reconstruction;
  Segments segments;

  UnfeltFlight(double sigma_airspeed, double sigma_alpha) {
    std::vector<double> t, alpha;
    for (int i = 0; i <= 600; ++i) {
      t.push_back(0.1 * i);
      alpha.push_back(2.0 * std::sqrt(2.0) * kDegree * std::sin(0.1 * kPi * i));
    }
    const TimeBase time = make_time_base(t);
    const auto constant = [&](double v) { return std::vector<double>(t.size(), v); };
    Recording& r = reconstruction.smoothed;
    r.add(make_channel("airspeed", "m/s", time, constant(20.0)));
    r.add(make_channel("sigma_airspeed", "m/s", time, constant(sigma_airspeed)));
    r.add(make_channel("alpha", "rad", time, alpha));
    r.add(make_channel("sigma_alpha", "rad", time, constant(sigma_alpha)));
    r.add(make_channel("sigma_wind_down", "m/s", time, constant(0.1)));
    for (const char* name : {"roll", "pitch", "vel_north", "vel_east", "beta"})
      recording.add(make_channel(name, "rad", time, constant(0.0)));
    segments.airborne = segments.longitudinal.excited = {{0.0, 60.0}};
  }
  [[nodiscard]] CheckedFlight checked() const { return missing_sensor_evidence(recording, reconstruction, segments); }
  [[nodiscard]] std::vector<Evidence> rows() const { return checked().rows; }
  [[nodiscard]] Evidence row(Check check) const {
    const std::vector<Evidence> all = rows();
    return *std::ranges::find(all, check, &Evidence::check);
  }
  [[nodiscard]] double sigma(BudgetSensor sensor, SensorErrorKind kind) const {
    const std::vector<SensorError> all = checked().errors;
    return std::ranges::find_if(all, [&](const SensorError& e) { return e.sensor == sensor && e.kind == kind; })->sigma;
  }
};

TEST(MissingSensorEvidence, SaysByHowMuchTheWindLeavesTheAirspeedInDoubt) {
  const UnfeltFlight sure(0.1, 0.001);
  EXPECT_NEAR(sure.row(Check::kNoAirspeedSensor).value, 0.1 / 20.0, 1e-12);
  EXPECT_EQ(sure.row(Check::kNoAirspeedSensor).outcome, Outcome::kNotVerified);
  EXPECT_NEAR(sure.sigma(BudgetSensor::kAirspeed, SensorErrorKind::kScale), 0.1 / 20.0, 1e-12);
  EXPECT_EQ(UnfeltFlight(0.4, 0.001).row(Check::kNoAirspeedSensor).outcome, Outcome::kCare);
  EXPECT_EQ(UnfeltFlight(1.0, 0.001).row(Check::kNoAirspeedSensor).outcome, Outcome::kFailed);
}

// Unknown over known variance: (0.05/2)^2, (0.15/2)^2, (1/2)^2.
TEST(MissingSensorEvidence, ComparesUnfeltGustsWithManoeuvres) {
  const UnfeltFlight calm(0.1, 0.05 * kDegree);
  EXPECT_NEAR(calm.row(Check::kNoVane).value, 0.000625, 3e-6);
  EXPECT_EQ(calm.row(Check::kNoVane).outcome, Outcome::kNotVerified);
  EXPECT_NEAR(calm.sigma(BudgetSensor::kAlpha, SensorErrorKind::kZero), 0.1 / 20.0, 1e-12);
  EXPECT_EQ(UnfeltFlight(0.1, 0.15 * kDegree).row(Check::kNoVane).outcome, Outcome::kCare);
  const Evidence gusty = UnfeltFlight(0.1, 1.0 * kDegree).row(Check::kNoVane);
  EXPECT_EQ(gusty.outcome, Outcome::kFailed);
  EXPECT_TRUE(affects(gusty, Coefficient::kCm));
  EXPECT_FALSE(affects(gusty, Coefficient::kCn));
  EXPECT_FALSE(gusty.bears_on.contains(estimation::Purpose::kPrediction)) << "it may predict in such gusts";
}

TEST(MissingSensorEvidence, HasNoRowOfWhatIsThere) {
  UnfeltFlight flight(1.0, 1.0);
  const TimeBase time = make_time_base({0.0, 60.0});
  for (const char* name : {"airspeed", "alpha"}) flight.recording.add(make_channel(name, "1", time, {0.0, 0.0}));
  EXPECT_TRUE(flight.rows().empty());
}

TEST(MissingSensorEvidence, AskNothingOfAFilterThatDidNotRunButTheNoiseOfTheAirspeed) {
  UnfeltFlight flight(0.1, 1.0);
  flight.reconstruction.filter = FilterKind::kNone;
  EXPECT_TRUE(flight.rows().empty());
  flight.recording = {};
  ASSERT_EQ(flight.rows().size(), 2U);
  EXPECT_EQ(flight.rows().front().check, Check::kNoGroundVelocity);
  UnfeltFlight noisy(0.4, 1.0);
  noisy.reconstruction.filter = FilterKind::kNone;
  EXPECT_EQ(noisy.row(Check::kAirspeedNoise).outcome, Outcome::kCare);
}

}  // namespace
}  // namespace veridyn::aircraft
