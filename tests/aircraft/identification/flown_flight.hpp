#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "veridyn/aircraft/identification/rows/prepared_flight.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/aircraft/model/flight_dynamics.hpp"
#include "veridyn/aircraft/model/trim.hpp"
#include "veridyn/numerics/ode.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/numerics/rotation.hpp"

/// A flight in calm air as `flight_dynamics.hpp` has it, with inertial velocity and a quaternion, doublets on each
/// surface in turn, and white noise on what is measured: signals as they are before anything is simulated
/// again, for tests of what does.
namespace veridyn::aircraft::testing {

struct FlownFlight {
  double duration_s = 40.0;
  double rate_Hz = 50.0;
  double noise = 1.0;  ///< over that of good sensors; 0: none
  std::uint64_t seed = 1;
  double first_doublet_s = 2.5;  ///< then one a second
  std::string name = {};
};

inline constexpr double kFlownDensity = 1.1;

/// Deflections on the grid; linear in between. Doublets of 3 deg, elevator, aileron and rudder in turn.
inline Controls<double> flown_controls(const Controls<double>& trim, const FlownFlight& flight, double t) {
  Controls<double> c = trim;
  const double since = t - flight.first_doublet_s;
  if (since < 0.0) return c;
  const double in_turn = std::fmod(since, 1.0);
  const double doublet = in_turn < 0.4 ? 0.05 : in_turn < 0.8 ? -0.05 : 0.0;
  const int which = static_cast<int>(since) % 3;
  (which == 0 ? c.de : which == 1 ? c.da : c.dr) += doublet;
  c.throttle += 0.05 * std::sin(0.5 * t);
  return c;
}

inline Controls<double> between(const Controls<double>& a, const Controls<double>& b, double share) {
  const auto on_line = [share](double x, double y) { return x + share * (y - x); };
  return {on_line(a.de, b.de), on_line(a.da, b.da), on_line(a.dr, b.dr), on_line(a.throttle, b.throttle), 0.0};
}

/// Where a motion of given air data, rates and angles is, in calm air.
inline RigidBodyState<double> rigid_body_at(double Va, double alpha, double beta, const Eigen::Vector3d& omega,
                                            double roll, double pitch) {
  RigidBodyState<double> x = RigidBodyState<double>::Zero();
  const Eigen::Quaterniond q = numerics::quaternion_from_euler(roll, pitch, 0.0);
  x.segment<4>(6) = q.coeffs();
  x.segment<3>(3) = q * Eigen::Vector3d(Va * std::cos(alpha) * std::cos(beta), Va * std::sin(beta),
                                        Va * std::sin(alpha) * std::cos(beta));
  x.tail<3>() = omega;
  return x;
}

/// Airspeed, alpha, beta, p, q, r, roll, pitch of a state in calm air.
inline Eigen::Matrix<double, 8, 1> flown_state(const RigidBodyState<double>& x) {
  const Eigen::Matrix3d R = R_body_from_ned(x);
  const AirData<double> air = air_data<double>(R * x.segment<3>(3));
  Eigen::Matrix<double, 8, 1> y;
  y << air.Va, air.alpha, air.beta, x(10), x(11), x(12), std::atan2(R(1, 2), R(2, 2)), -std::asin(R(0, 2));
  return y;
}

/// @param subject  its thrust must not depend on airspeed (a recorded thrust does not either)
inline PreparedFlight flown(const Subject& subject, const FlownFlight& flight = {}) {
  const Trim trim = find_trim(subject, {.airspeed = 20.0, .density = kFlownDensity});
  const MassProperties body(subject.mass, subject.inertia->matrix());
  PreparedFlight out;
  out.name = flight.name;
  FlightSignals& s = out.signals;
  s.grid = numerics::UniformGrid::covering(0.0, flight.duration_s, 1.0 / flight.rate_Hz);
  const std::size_t n = s.size();
  for (auto& signal : s.signals) signal.value.assign(n, 0.0);
  for (auto* angle : {&s.roll, &s.pitch, &s.yaw}) angle->assign(n, 0.0);
  s.air_density.assign(n, kFlownDensity);
  numerics::RandomStream random(flight.seed, "flown");
  const auto sigma = [&](FlightSignal which, double value) {
    s[which].sigma = flight.noise * value;
    s[which].error = ErrorKind::kClassical;
  };
  sigma(FlightSignal::kAirspeed, 0.2);
  for (const FlightSignal angle : {FlightSignal::kAlpha, FlightSignal::kBeta}) sigma(angle, 0.004);
  for (const FlightSignal rate : {FlightSignal::kP, FlightSignal::kQ, FlightSignal::kR}) sigma(rate, 0.003);
  // Errors of attitude that are white count as such only where no smoother says otherwise.
  const double angle_sigma = flight.noise * 0.003;
  RigidBodyState<double> x = rigid_body_at(20.0, trim.alpha, trim.beta, Eigen::Vector3d::Zero(), 0.0, trim.theta);
  for (std::size_t k = 0; k < n; ++k) {
    const double t = s.grid.at(k);
    const Controls<double> now = flown_controls(trim.controls, flight, t);
    const Controls<double> next = flown_controls(trim.controls, flight, s.grid.at(k + 1));
    const AeroLoads<double> loads =
        aero_loads<double>(subject, R_body_from_ned(x) * x.segment<3>(3), x.tail<3>(), now, kFlownDensity);
    const Eigen::Matrix<double, 8, 1> y = flown_state(x);
    const auto measured = [&](FlightSignal which, double value) {
      s[which].value[k] = value + s[which].sigma * random.normal();
    };
    measured(FlightSignal::kAirspeed, y(0));
    measured(FlightSignal::kAlpha, y(1));
    measured(FlightSignal::kBeta, y(2));
    measured(FlightSignal::kP, y(3));
    measured(FlightSignal::kQ, y(4));
    measured(FlightSignal::kR, y(5));
    s.roll[k] = y(6) + angle_sigma * random.normal();
    s.pitch[k] = y(7) + angle_sigma * random.normal();
    measured(FlightSignal::kAx, loads.force(0) / subject.mass);
    measured(FlightSignal::kAy, loads.force(1) / subject.mass);
    measured(FlightSignal::kAz, loads.force(2) / subject.mass);
    s[FlightSignal::kElevator].value[k] = now.de;
    s[FlightSignal::kAileron].value[k] = now.da;
    s[FlightSignal::kRudder].value[k] = now.dr;
    s[FlightSignal::kThrust].value[k] = loads.propulsion.thrust;
    constexpr int kSteps = 20;
    const double h = s.grid.step / kSteps;
    for (int j = 0; j < kSteps; ++j) {
      const auto rate = [&](double at, const RigidBodyState<double>& state) {
        return aircraft_rate<double>(subject, body, state, between(now, next, (at - t) / s.grid.step),
                                     Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), kFlownDensity, kGravity);
      };
      x = numerics::runge_kutta_4_step(rate, t + h * j, x, h);
      normalise_attitude(x);
    }
  }
  out.segments.airborne = {{0.0, flight.duration_s}};
  for (AxisSegments* axis : {&out.segments.longitudinal, &out.segments.lateral}) {
    axis->excited = out.segments.airborne;
    axis->holdout = out.segments.airborne;
  }
  out.segments.lateral.axis = Axis::kLateral;
  return out;
}

/// UnATRaP with a thrust that a recording can hold: of the throttle alone, off the centre of gravity.
inline Subject flown_subject() {
  Subject s = builtin_subject("unatrap");
  s.propulsion = {};
  s.propulsion.kind = PropulsionKind::kPolynomial;
  s.propulsion.polynomial = {{1, 0, 60.0}};
  s.propulsion.position = {0.3, 0.0, -0.02};
  s.force_point = {-0.01, 0.0, 0.02};
  return s;
}

}  // namespace veridyn::aircraft::testing
