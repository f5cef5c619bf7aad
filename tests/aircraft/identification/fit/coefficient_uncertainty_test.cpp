#include "veridyn/aircraft/identification/fit/coefficient_uncertainty.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::aircraft {
namespace {

using F = FlightSignal;

/// A minute of random but smooth flight; q and alpha go together.
FlightSignals made_signals() {
  FlightSignals s;
  s.grid = numerics::UniformGrid::covering(0.0, 60.0, 0.02);
  for (auto& signal : s.signals) signal.value.assign(s.grid.count, 0.0);
  s.air_density.assign(s.grid.count, 1.2);
  for (std::size_t k = 0; k < s.grid.count; ++k) {
    const double t = 0.02 * static_cast<double>(k);
    s[F::kAirspeed].value[k] = 20.0 + 2.0 * std::sin(0.7 * t);
    s[F::kAlpha].value[k] = 0.08 + 0.05 * std::sin(2.0 * t);
    s[F::kQ].value[k] = 0.4 * std::sin(2.0 * t);
    s[F::kQdot].value[k] = 0.8 * std::cos(2.0 * t);
    s[F::kP].value[k] = 0.5 * std::sin(1.3 * t);
    s[F::kPdot].value[k] = 0.65 * std::cos(1.3 * t);
    s[F::kAx].value[k] = 1.0 + 0.3 * std::sin(0.9 * t);
    s[F::kAz].value[k] = -9.8 - 3.0 * std::sin(2.0 * t);
    s[F::kThrust].value[k] = 5.0;
  }
  s[F::kAz].sigma = 0.05;
  s[F::kAlpha].sigma = 0.01;
  s[F::kQdot].sigma = 0.05;
  return s;
}

Segments all_airborne() {
  Segments segments;
  segments.airborne = {{0.0, 60.0}};
  return segments;
}

/// The only flight of a study.
std::vector<PreparedFlight> only_made_flight(FlightSignals signals, Segments segments = all_airborne()) {
  std::vector<PreparedFlight> flights(1);
  flights.front().signals = std::move(signals);
  flights.front().segments = std::move(segments);
  return flights;
}

TEST(CoefficientUncertainty, TakesRangesAndCorrelationFromTheFlight) {
  const Subject subject = builtin_subject("thor");
  const auto inputs = coefficient_inputs(only_made_flight(made_signals()), subject, {});
  ASSERT_EQ(inputs.names.size(), kCoefficientInputs);
  const auto at = [](F f) { return static_cast<Eigen::Index>(f); };
  EXPECT_NEAR(inputs.low(at(F::kAirspeed)), 18.0, 0.01);
  EXPECT_NEAR(inputs.high(at(F::kAirspeed)), 22.0, 0.01);
  EXPECT_NEAR(inputs.correlation(at(F::kAlpha), at(F::kQ)), 1.0, 1e-9);
  EXPECT_NEAR(inputs.correlation(at(F::kAlpha), at(F::kAz)), -1.0, 1e-9);
  EXPECT_LT(std::abs(inputs.correlation(at(F::kAlpha), at(F::kP))), 0.1);
  EXPECT_EQ(inputs.low(at(F::kThrust)), 5.0);
  EXPECT_EQ(inputs.high(at(F::kThrust)), 5.0);
  EXPECT_EQ(inputs.low(kFlightSignals + 1), subject.mass);
}

TEST(CoefficientUncertainty, AgreesWithTheLinearLawWhereErrorsAreSmallAndSplitsItIntoItsSources) {
  Subject subject = builtin_subject("thor");
  subject.sigma.mass = 0.02;
  subject.sigma.Jy = 0.004;
  const auto inputs = coefficient_inputs(only_made_flight(made_signals()), subject, {});
  const UncertaintyReport report = coefficient_uncertainty(inputs, subject, {}, 3);
  ASSERT_EQ(report.coefficients.size(), 6U);
  for (const CoefficientUncertainty& c : report.coefficients) {
    // Errors of a percent: the linear law holds to a percent; sampling adds 0.3 % and the 500 points of the mean 3 %.
    EXPECT_NEAR(c.error.sd, c.sigma_linear, 0.05 * c.sigma_linear + 1e-15) << name_of(c.coefficient);
    EXPECT_NEAR(std::hypot(c.sigma_sensors, c.sigma_body), c.sigma_linear, 1e-12);
  }
  // Cm = Jy q'/(qbar S c) + coupling: its error by Jy alone is sigma_Jy rms(q')/(qbar S c), the pitch coupling does not
  // hold Jy. Uniform on +-0.8 q' has rms 0.8/sqrt 3; qbar varies, hence 5 %.
  const double qbar = 0.5 * 1.2 * 400.0;
  const CoefficientUncertainty& cm = report.coefficients[4];
  EXPECT_NEAR(cm.sigma_body, 0.004 * (0.8 / std::sqrt(3.0)) / (qbar * subject.wing_area * subject.chord),
              0.05 * cm.sigma_body);
  EXPECT_NEAR(report.coefficients[0].sigma_body, 0.02 * 9.8 / (qbar * subject.wing_area),
              0.05 * report.coefficients[0].sigma_body);
}

TEST(CoefficientUncertainty, IsReproducibleAndLeavesOutWhatCannotBeMeasured) {
  Subject subject = builtin_subject("thor");
  subject.inertia.reset();
  const auto inputs = coefficient_inputs(only_made_flight(made_signals()), subject, {});
  UncertaintyOptions options;
  options.draws = 5000;
  const UncertaintyReport a = coefficient_uncertainty(inputs, subject, options, 3, 1);
  const UncertaintyReport b = coefficient_uncertainty(inputs, subject, options, 3, 4);
  ASSERT_EQ(a.coefficients.size(), 3U);
  EXPECT_EQ(to_csv(a), to_csv(b));
  EXPECT_FALSE(
      coefficient_uncertainty(coefficient_inputs(only_made_flight(made_signals(), {}), subject, {}), subject, {}, 1)
          .available());
}

TEST(CoefficientUncertainty, ReadsItsTableAndRefusesNonsense) {
  const Study study =
      Study::parse("[uncertainty]\ndraws = 1000\nsigma = { thrust = 0.5, alpha = \"1 deg\" }\n", "s.toml");
  const UncertaintyOptions options = UncertaintyOptions::keys().read(study.root().table("uncertainty"));
  EXPECT_EQ(options.draws, 1000U);
  EXPECT_NEAR(*options.sigma[0], M_PI / 180.0, 1e-15);
  FlightSignals signals = made_signals();
  const auto inputs = coefficient_inputs(only_made_flight(signals), builtin_subject("thor"), options);
  EXPECT_EQ(inputs.error_covariance(15, 15), 0.25);
  for (const auto& [text, message] : std::vector<std::pair<std::string, std::string>>{
           {"[uncertainty]\ndraws = 5\n", "s.toml:2: uncertainty.draws: = 5 must be from 100 to 100000000"},
           {"[uncertainty.sigma]\nthrust = -1\n", "s.toml:2: uncertainty.sigma.thrust: = -1 must be >= 0"}}) {
    const Study wrong = Study::parse(text, "s.toml");
    try {
      static_cast<void>(UncertaintyOptions::keys().read(wrong.root().table("uncertainty")));
      FAIL();
    } catch (const InputError& e) {
      EXPECT_EQ(e.what(), message);
    }
  }
}

}  // namespace
}  // namespace veridyn::aircraft
