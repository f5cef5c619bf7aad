#include "veridyn/aircraft/model/modes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/aircraft/model/flight_dynamics.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/linear_algebra/general_eigen.hpp"
#include "veridyn/numerics/ode.hpp"

namespace veridyn::aircraft {
namespace {

constexpr double kDensity = 1.2;

/// How far a root is from the nearest of others, as a share of itself.
double off(const std::complex<double>& root, const Eigen::VectorXcd& others) {
  double nearest = kInfinity;
  for (const std::complex<double>& other : others) nearest = std::min(nearest, std::abs(root - other));
  return nearest / std::abs(root);
}

/// Near a trim, but not at it.
Trim beside(Trim trim) {
  trim.alpha += 0.03;
  trim.controls.throttle = 0.0;
  return trim;
}

// The eigenvalues of all eight states together, in which longitudinal and lateral motion are not taken apart.
TEST(FlightModes, AreThoseOfTheWholeAircraft) {
  int flown = 0;
  for (const std::string& name : builtin_subject_names()) {
    const Subject s = builtin_subject(name);
    if (!s.inertia || !s.model.unknown_parameters().empty()) continue;
    const Trim trim = find_trim(s, {.airspeed = 18.0, .density = kDensity});
    if (!trim.usable()) continue;
    const FlightModes found = flight_modes(s, beside(trim));
    const Eigen::VectorXcd all = numerics::general_eigenvalues(linearise(s, trim).A);
    for (const Mode mode : enumerators<Mode, kModes>()) {
      if (!found.modes[mode]) continue;
      ++flown;
      // The engine's torque couples the slowest motion to the others.
      EXPECT_LT(off(found.modes[mode]->first, all), mode == Mode::kSpiral ? 0.2 : 0.02)
          << name << " " << words_of(mode);
    }
  }
  EXPECT_GT(flown, 12);
}

/// Moments at which a signal passes zero.
std::vector<double> crossings(const std::vector<double>& x, double step) {
  std::vector<double> at;
  for (std::size_t k = 1; k < x.size(); ++k)
    if ((x[k - 1] < 0.0) != (x[k] < 0.0))
      at.push_back(step * (static_cast<double>(k - 1) + x[k - 1] / (x[k - 1] - x[k])));
  return at;
}

/// Heading rate after the sideslip is let go at half a degree: the flight itself, by Runge-Kutta's method.
std::vector<double> yaw_rate_of_flight(const Subject& s, const Trim& trim, double step, std::size_t count) {
  const MassProperties body(s.mass, s.inertia->matrix());
  RigidBodyState<double> x = RigidBodyState<double>::Zero();
  const Eigen::Quaterniond attitude(numerics::R_body_from_ned(0.0, trim.theta, 0.0).transpose());
  x.segment<3>(3) = attitude * air_velocity(trim.condition.airspeed, trim.alpha, trim.beta + 0.5 * kDegree);
  x.segment<4>(6) = attitude.coeffs();
  const auto rate = [&](double, const RigidBodyState<double>& at) {
    return aircraft_rate<double>(s, body, at, trim.controls, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), kDensity,
                                 kGravity);
  };
  std::vector<double> r;
  for (std::size_t k = 0; k < count; ++k) {
    r.push_back(x(12));
    x = numerics::runge_kutta_4_step(rate, 0.0, x, step);
    normalise_attitude(x);
  }
  return r;
}

TEST(FlightModes, AreWhatTheAircraftDoes) {
  const Subject s = builtin_subject("x8");  // whose Dutch roll lasts
  const Trim trim = find_trim(s, {.airspeed = 20.0, .density = kDensity});
  ASSERT_TRUE(trim.usable());
  const NaturalMode dutch_roll = flight_modes(s, beside(trim)).modes[Mode::kDutchRoll].value();
  constexpr double kStep = 0.002;
  const std::vector<double> r = yaw_rate_of_flight(s, trim, kStep, 3000);
  const std::vector<double> zero = crossings(r, kStep);
  ASSERT_GT(zero.size(), 5u);
  // By then the roll mode is over, and the spiral is still small.
  const double damped = dutch_roll.frequency() * std::sqrt(1.0 - std::pow(dutch_roll.damping(), 2));
  EXPECT_NEAR(2.0 * kFullTurn / (zero[5] - zero[1]), damped, 0.03 * damped);
}

// At constant thrust and with an alpha that nothing moves the phugoid is Lanchester's: sqrt(2) g / V (Lanchester 1908).
TEST(FlightModes, HaveLanchestersPhugoidWhereAlphaStays) {
  Subject s = builtin_subject("unatrap");
  s.propulsion = {};
  s.model.at(Coefficient::kCm) = coefficient_model(
      Coefficient::kCm,
      std::vector<std::pair<std::string_view, double>>{{"alpha", -60.0}, {"q_n", -10.0}, {"de", -60.0}});
  const double speed = 25.0;
  const Trim at{.condition = {.airspeed = speed, .density = kDensity}, .alpha = 0.05};
  const FlightModes found = flight_modes(s, at, {.thrust = 0.0});
  const double lanchester = std::sqrt(2.0) * kGravity / speed;
  EXPECT_NEAR(found.modes[Mode::kPhugoid].value().frequency(), lanchester, 0.02 * lanchester);
}

// A thrust that falls with airspeed as a modelled engine's does, not modelled: the same phugoid.
TEST(FlightModes, KnowAnEngineByItsPowerOfAirspeed) {
  Subject s = builtin_subject("unatrap");
  const Trim at{.condition = {.airspeed = 20.0, .density = kDensity}, .alpha = 0.05};
  for (const double power : {0.0, 1.0, 2.0}) {
    s.propulsion = {};
    const FlightModes not_modelled = flight_modes(s, at, {.thrust = power});
    s.propulsion.kind = PropulsionKind::kPolynomial;
    // The tangent of Va^-power at 20 m/s.
    s.propulsion.polynomial = {{1, 0, 100.0 * (1.0 + power)}, {1, 1, -100.0 * power / 20.0}};
    const NaturalMode phugoid = flight_modes(s, at).modes[Mode::kPhugoid].value();
    EXPECT_NEAR(not_modelled.modes[Mode::kPhugoid].value().damping(), phugoid.damping(), 0.02 * phugoid.damping());
  }
}

TEST(FlightModes, NeedOnlyTheCoefficientsThatTheyFollowFrom) {
  const Subject s = builtin_subject("unatrap");
  const Trim at{.condition = {.airspeed = 20.0, .density = kDensity}, .alpha = 0.05};
  const FlightModes all = flight_modes(s, at);
  Subject part = s;
  part.model.at(Coefficient::kCD).values.front() = kNaN;
  part.model.at(Coefficient::kCn).values.front() = kNaN;
  const FlightModes some = flight_modes(part, at);
  const auto frequency = [](const FlightModes& of) { return of.modes[Mode::kShortPeriod].value().frequency(); };
  EXPECT_NEAR(frequency(some), frequency(all), 0.05 * frequency(all));
  EXPECT_FALSE(some.modes[Mode::kPhugoid]);
  EXPECT_FALSE(some.modes[Mode::kDutchRoll]);
  EXPECT_FALSE(some.modes[Mode::kSpiral]);
  const double roll = all.modes[Mode::kRoll].value().decay();
  EXPECT_NEAR(some.modes[Mode::kRoll].value().decay(), roll, 0.3 * roll);
  EXPECT_TRUE(all.longitudinal_whole);
  EXPECT_FALSE(some.longitudinal_whole);
  EXPECT_FALSE(some.lateral_whole);
  part.inertia.reset();
  EXPECT_FALSE(flight_modes(part, at).modes[Mode::kShortPeriod]);
}

// Lift by the fourth power of airspeed in place of the second: Lanchester's phugoid times the root of two.
TEST(FlightModes, KnowALiftThatGrowsFasterWithAirspeed) {
  Subject s = builtin_subject("x8");
  s.propulsion = {};
  const Trim at{.condition = {.airspeed = 25.0, .density = kDensity}, .alpha = 0.05};
  const auto frequency = [&](double lift) {
    return flight_modes(s, at, {.thrust = 0.0, .lift = lift}).modes[Mode::kPhugoid].value().frequency();
  };
  EXPECT_NEAR(frequency(1.0) / frequency(0.0), std::sqrt(2.0), 0.1);
}

// n/alpha = qbar S (CL_alpha + CD) / (m g), since the force's x turns into z too, and CAP by its definition.
TEST(FlightModes, HaveTheLoadFactorOfTheirLift) {
  const Subject s = builtin_subject("unatrap");
  const Trim at{.condition = {.airspeed = 20.0, .density = kDensity}, .alpha = 0.05};
  const FlightModes found = flight_modes(s, at);
  const double slope = s.model.at(Coefficient::kCL).value_of("alpha").value() + 0.16;  // CD at that alpha
  const double per_alpha = 0.5 * kDensity * 400.0 * s.wing_area * slope / (s.mass * kGravity);
  EXPECT_NEAR(found.load_factor_per_alpha, per_alpha, 0.02 * per_alpha);
  EXPECT_DOUBLE_EQ(found.control_anticipation,
                   std::pow(found.modes[Mode::kShortPeriod].value().frequency(), 2) / found.load_factor_per_alpha);
}

}  // namespace
}  // namespace veridyn::aircraft
