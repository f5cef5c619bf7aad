#pragma once

#include "veridyn/aircraft/model/air_data.hpp"
#include "veridyn/aircraft/model/rigid_body.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/numerics/linear_systems/washout.hpp"

namespace veridyn::aircraft {

/// Deflections [rad] and throttle [0, 1] as they are, behind the servos, and the rotor's speed [rad/s].
template <typename Scalar>
struct Controls {
  Scalar de{0.0}, da{0.0}, dr{0.0};
  Scalar throttle{0.0};
  Scalar rotor_speed{0.0};
};

/// What acts on the aircraft, and the air data it comes from.
template <typename Scalar>
struct AeroLoads {
  AirData<Scalar> air;
  AeroVariables<Scalar> variables;
  AeroCoefficients<Scalar> coefficients;  ///< of the model, moments about `Subject::force_point`
  PropulsionLoad<Scalar> propulsion;
  Scalar dynamic_pressure{0.0};      ///< [Pa]
  numerics::Vector3<Scalar> force;   ///< all but gravity, body axes [N]
  numerics::Vector3<Scalar> moment;  ///< about the centre of gravity, body axes [N m]
};

/// Aerodynamic and propulsive loads at a velocity relative to the (gusty) air `v_r` and body rates `omega`, in body
/// axes.
///
/// Lift and drag act in the plane of symmetry, along the wind axes at beta = 0, the side force along body y:
/// F = qbar S [-CD cos a + CL sin a, CY, -CD sin a - CL cos a], applied at `Subject::force_point`; thrust along body x
/// at `Propulsion::position`. Below 0.1 m/s normalised rates are taken as at 0.1 m/s. Does not throw or allocate.
/// @param downwash_lag  alpha - alpha_w of `Downwash` [rad]
template <typename Scalar>
[[nodiscard]] AeroLoads<Scalar> aero_loads(const Subject& s, const numerics::Vector3<Scalar>& v_r,
                                           const numerics::Vector3<Scalar>& omega, const Controls<Scalar>& controls,
                                           const Scalar& rho, const Scalar& downwash_lag = Scalar(0.0)) {
  using std::cos;
  using std::sin;
  AeroLoads<Scalar> out;
  out.air = air_data(v_r);
  const Scalar Va = out.air.Va;
  const Scalar slow(0.1);
  const Scalar Vn = Va > slow ? Va : slow;
  out.dynamic_pressure = Scalar(0.5) * rho * Va * Va;
  out.propulsion = s.propulsion.load(controls.throttle, v_r(0), rho, controls.rotor_speed);
  AeroVariables<Scalar>& v = out.variables;
  v.alpha = out.air.alpha;
  v.beta = out.air.beta;
  v.p_n = Scalar(0.5 * s.roll_length()) * omega(0) / Vn;
  v.q_n = Scalar(0.5 * s.pitch_length()) * omega(1) / Vn;
  v.r_n = Scalar(0.5 * s.yaw_length()) * omega(2) / Vn;
  v.de = controls.de;
  v.da = controls.da;
  v.dr = controls.dr;
  v.CT = out.propulsion.thrust / (Scalar(0.5 * s.wing_area) * rho * Vn * Vn);
  v.Va = Va;
  out.coefficients = s.model.evaluate(v);
  if (s.downwash.any()) {
    const Scalar lag = downwash_lag * Scalar(0.5 * s.pitch_length() / s.downwash.tail_arm);
    out.coefficients.CL += Scalar(s.downwash.CL_alphadot) * lag;
    out.coefficients.Cm += Scalar(s.downwash.Cm_alphadot) * lag;
  }
  const AeroCoefficients<Scalar>& c = out.coefficients;

  const Scalar qS = out.dynamic_pressure * Scalar(s.wing_area);
  const Scalar ca = cos(v.alpha), sa = sin(v.alpha);
  using Vector = numerics::Vector3<Scalar>;
  const Vector aero(qS * (c.CL * sa - c.CD * ca), qS * c.CY, qS * (-c.CD * sa - c.CL * ca));
  const Vector arm(Scalar(s.force_point[0]), Scalar(s.force_point[1]), Scalar(s.force_point[2]));
  const Vector engine(Scalar(s.propulsion.position[0]), Scalar(s.propulsion.position[1]),
                      Scalar(s.propulsion.position[2]));
  const Vector thrust(out.propulsion.thrust, Scalar(0.0), Scalar(0.0));
  out.force = aero + thrust;
  out.moment = Vector(qS * Scalar(s.roll_length()) * c.Cl + out.propulsion.torque, qS * Scalar(s.pitch_length()) * c.Cm,
                      qS * Scalar(s.yaw_length()) * c.Cn) +
               arm.cross(aero) + engine.cross(thrust);
  return out;
}

/// What the air does to the aircraft besides moving as a whole; as it is, nothing. Within a step of an integration.
template <typename Scalar>
struct UnsteadyAir {
  numerics::Vector3<Scalar> gust_rates{Scalar(0.0), Scalar(0.0), Scalar(0.0)};  ///< p_g, q_g, r_g [rad/s]
  Scalar alpha{0.0}, downwash_lag{0.0};                                         ///< at the beginning of the step [rad]
  Scalar elapsed{0.0};                                                          ///< since then [s]

  /// alpha - alpha_w of `Downwash` now [rad], where alpha has changed linearly.
  [[nodiscard]] Scalar lag(const Downwash& downwash, const AirData<Scalar>& now) const {
    if (!downwash.any()) return Scalar(0.0);
    return numerics::washed_out(downwash_lag, now.alpha - alpha, elapsed * now.Va / downwash.tail_arm);
  }
};

/// Rate of change of the aircraft's state in air that moves with `wind_N` (NED) plus `gust_B` (body axes) [m/s].
template <typename Scalar>
[[nodiscard]] RigidBodyState<Scalar> aircraft_rate(const Subject& s, const MassProperties& body,
                                                   const RigidBodyState<Scalar>& x, const Controls<Scalar>& controls,
                                                   const numerics::Vector3<Scalar>& wind_N,
                                                   const numerics::Vector3<Scalar>& gust_B, const Scalar& rho,
                                                   double gravity, const UnsteadyAir<Scalar>& air = {}) {
  const numerics::Vector3<Scalar> v_r = R_body_from_ned(x) * (x.template segment<3>(3) - wind_N) - gust_B;
  const numerics::Vector3<Scalar> rates = x.template tail<3>() + air.gust_rates;
  const AeroLoads<Scalar> loads =
      aero_loads<Scalar>(s, v_r, rates, controls, rho, air.lag(s.downwash, air_data<Scalar>(v_r)));
  return rigid_body_rate(x, body, loads.force, loads.moment, gravity);
}

}  // namespace veridyn::aircraft
