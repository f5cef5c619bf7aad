#include "veridyn/aircraft/identification/validation/validation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/aircraft/model/flight_dynamics.hpp"
#include "veridyn/aircraft/model/trim.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

using F = FlightSignal;

/// Steady level flight at the trim for 20 s.
FlightSignals trimmed_flight(const Subject& subject, double airspeed) {
  const double rho = 1.2;
  const Trim trim = find_trim(subject, {.airspeed = airspeed, .density = rho});
  const AeroLoads<double> loads = aero_loads<double>(subject, air_velocity(airspeed, trim.alpha, trim.beta),
                                                     Eigen::Vector3d::Zero(), trim.controls, rho);
  FlightSignals s;
  s.grid = {0.0, 0.02, 1001};
  for (GridSignal& signal : s.signals) signal.value.assign(s.size(), 0.0);
  const auto hold = [&](F signal, double value) { s[signal].value.assign(s.size(), value); };
  hold(F::kAirspeed, airspeed);
  hold(F::kAlpha, trim.alpha);
  hold(F::kBeta, trim.beta);
  hold(F::kAx, loads.force(0) / subject.mass);
  hold(F::kAy, loads.force(1) / subject.mass);
  hold(F::kAz, loads.force(2) / subject.mass);
  hold(F::kElevator, trim.controls.de);
  hold(F::kAileron, trim.controls.da);
  hold(F::kRudder, trim.controls.dr);
  hold(F::kThrust, loads.propulsion.thrust);
  s.air_density.assign(s.size(), rho);
  s.roll.assign(s.size(), 0.0);
  s.pitch.assign(s.size(), trim.theta);
  return s;
}

const std::vector<TimeSpan> kWhole{{0.0, 20.0}};
const std::vector<Coefficient> kLiftAndDrag{Coefficient::kCL, Coefficient::kCD};

TEST(Validation, ARightModelStaysWhereTheFlightStays) {
  const Subject subject = builtin_subject("unatrap");
  const FlightSignals signals = trimmed_flight(subject, 20.0);
  const Validation v = validate_flight(signals, kWhole, kWhole, subject, kLiftAndDrag, {});
  EXPECT_EQ(v.windows, 4u);
  EXPECT_EQ(v.diverged, 0u);
  ASSERT_EQ(v.quantities.size(), 2u);
  EXPECT_EQ(v.quantities[0].name, "airspeed");
  EXPECT_LT(v.quantities[0].fit.mae, 1e-6);
  EXPECT_LT(v.quantities[1].fit.mae, 1e-6);
}

TEST(Validation, AWrongModelLeavesTheFlight) {
  const Subject subject = builtin_subject("unatrap");
  Subject wrong = subject;
  wrong.model.at(Coefficient::kCL).values[0] += 0.1;
  const FlightSignals signals = trimmed_flight(subject, 20.0);
  const Validation v = validate_flight(signals, kWhole, kWhole, wrong, kLiftAndDrag, {});
  ASSERT_EQ(v.quantities.size(), 2u);
  EXPECT_GT(v.quantities[1].fit.mae, 0.5) << "deg";
}

TEST(Validation, IsNotAvailableWithoutLiftAndSideForce) {
  const Subject subject = builtin_subject("unatrap");
  const Validation v = validate_flight(trimmed_flight(subject, 20.0), kWhole, kWhole, subject,
                                       std::vector<Coefficient>{Coefficient::kCm}, {});
  EXPECT_FALSE(v.available());
  EXPECT_THAT(v.text, ::testing::HasSubstr("no validation"));
}

}  // namespace
}  // namespace veridyn::aircraft
