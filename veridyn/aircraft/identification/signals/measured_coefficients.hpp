#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "veridyn/aircraft/model/aero_model.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/core/enum_array.hpp"

namespace veridyn::aircraft {

/// What the coefficients are computed from. All at the centre of gravity, body axes, SI.
enum class FlightSignal {
  kAlpha,
  kBeta,
  kAirspeed,
  kAx,
  kAy,
  kAz,
  kP,
  kQ,
  kR,
  kPdot,
  kQdot,
  kRdot,
  kElevator,
  kAileron,
  kRudder,
  kThrust
};
inline constexpr std::size_t kFlightSignals = 16;  ///< values of FlightSignal
/// As in reports and messages.
inline constexpr EnumArray<FlightSignal, std::string_view, kFlightSignals> kFlightSignalNames{
    {"alpha", "beta", "airspeed", "accel_x", "accel_y", "accel_z", "p", "q", "r", "p_dot", "q_dot", "r_dot", "elevator",
     "aileron", "rudder", "thrust"}};

/// One sample of the flight signals: rad, m/s, m/s^2 (specific force), rad/s, rad/s^2, N.
template <typename Scalar>
struct FlightSample {
  EnumArray<FlightSignal, Scalar, kFlightSignals> value{};
  [[nodiscard]] const Scalar& operator[](FlightSignal s) const { return value[s]; }
  [[nodiscard]] Scalar& operator[](FlightSignal s) { return value[s]; }
};

/// Variables of the aerodynamic model at a sample; `rho` is the air density [kg/m^3].
template <typename Scalar>
[[nodiscard]] AeroVariables<Scalar> aero_variables(const FlightSample<Scalar>& s, const Subject& subject, double rho) {
  using F = FlightSignal;
  AeroVariables<Scalar> v;
  const Scalar& Va = s[F::kAirspeed];
  v.alpha = s[F::kAlpha];
  v.beta = s[F::kBeta];
  v.p_n = s[F::kP] * Scalar(0.5 * subject.roll_length()) / Va;
  v.q_n = s[F::kQ] * Scalar(0.5 * subject.pitch_length()) / Va;
  v.r_n = s[F::kR] * Scalar(0.5 * subject.yaw_length()) / Va;
  v.de = s[F::kElevator];
  v.da = s[F::kAileron];
  v.dr = s[F::kRudder];
  v.Va = Va;
  v.CT = s[F::kThrust] / (Scalar(0.5 * rho * subject.wing_area) * Va * Va);
  return v;
}

/// The constants of the aircraft that enter the coefficients, as a type that can carry derivatives or errors.
enum class BodyConstant { kMass, kWingArea, kSpan, kChord, kJx, kJy, kJz, kJxz };
inline constexpr std::size_t kBodyConstants = 8;  ///< values of BodyConstant
/// As in studies.
inline constexpr EnumArray<BodyConstant, std::string_view, kBodyConstants> kBodyConstantNames{
    {"mass", "wing_area", "span", "chord", "Jx", "Jy", "Jz", "Jxz"}};

/// kg, m^2, m, m, kg m^2; inertia is zero when the subject has none.
template <typename Scalar>
struct BodyConstants {
  EnumArray<BodyConstant, Scalar, kBodyConstants> value{};
  [[nodiscard]] const Scalar& operator[](BodyConstant c) const { return value[c]; }
  [[nodiscard]] Scalar& operator[](BodyConstant c) { return value[c]; }
};

/// The subject's constants.
template <typename Scalar>
[[nodiscard]] BodyConstants<Scalar> body_constants(const Subject& subject) {
  const Inertia J = subject.inertia.value_or(Inertia{});
  return {{{Scalar(subject.mass), Scalar(subject.wing_area), Scalar(subject.span), Scalar(subject.chord), Scalar(J.Jx),
            Scalar(J.Jy), Scalar(J.Jz), Scalar(J.Jxz)}}};
}

/// Coefficients from specific force, thrust, rates and rate derivatives: the rigid-body equations solved for the
/// aerodynamics (docs/aircraft.md, "Coefficients"). Without `subject.inertia` the three moment coefficients are zero
/// and must not be used. `torque` is the engine's reaction about x [N m]. The aerodynamic force is taken to act at the
/// centre of gravity; `subject.force_point` moves the moments. `body` overrides the subject's constants.
template <typename Scalar>
[[nodiscard]] AeroCoefficients<Scalar> measured_coefficients(const FlightSample<Scalar>& s, const Subject& subject,
                                                             const BodyConstants<Scalar>& body, const Scalar& rho,
                                                             const Scalar& torque) {
  using F = FlightSignal;
  using B = BodyConstant;
  using std::cos;
  using std::sin;
  const Scalar& Va = s[F::kAirspeed];
  const Scalar qS = Scalar(0.5) * rho * body[B::kWingArea] * Va * Va;
  const Scalar ca = cos(s[F::kAlpha]);
  const Scalar sa = sin(s[F::kAlpha]);
  const Scalar Fx = body[B::kMass] * s[F::kAx] - s[F::kThrust];
  const Scalar Fy = body[B::kMass] * s[F::kAy];
  const Scalar Fz = body[B::kMass] * s[F::kAz];
  AeroCoefficients<Scalar> c;
  c.CL = (Fx * sa - Fz * ca) / qS;
  c.CD = -(Fx * ca + Fz * sa) / qS;
  c.CY = Fy / qS;
  if (!subject.inertia) return c;
  const Scalar &Jx = body[B::kJx], &Jy = body[B::kJy], &Jz = body[B::kJz], &Jxz = body[B::kJxz];
  const Scalar &p = s[F::kP], &q = s[F::kQ], &r = s[F::kR];
  const Scalar &dp = s[F::kPdot], &dq = s[F::kQdot], &dr = s[F::kRdot];
  Scalar l = Jx * dp - Jxz * dr + (Jz - Jy) * q * r - Jxz * p * q - torque;
  Scalar m = Jy * dq + (Jx - Jz) * p * r + Jxz * (p * p - r * r);
  Scalar n = Jz * dr - Jxz * dp + (Jy - Jx) * p * q + Jxz * q * r;
  // Moments of thrust and of the aerodynamic force about the centre of gravity: r x F.
  const auto& e = subject.propulsion.position;
  m -= Scalar(e[2]) * s[F::kThrust];
  n += Scalar(e[1]) * s[F::kThrust];
  const auto& f = subject.force_point;
  l -= Scalar(f[1]) * Fz - Scalar(f[2]) * Fy;
  m -= Scalar(f[2]) * Fx - Scalar(f[0]) * Fz;
  n -= Scalar(f[0]) * Fy - Scalar(f[1]) * Fx;
  // Lengths by definition have no error; span and chord may.
  const auto length = [](const std::optional<double>& given, const Scalar& measured) {
    return given ? Scalar(*given) : measured;
  };
  c.Cl = l / (qS * length(subject.lengths.roll, body[B::kSpan]));
  c.Cm = m / (qS * length(subject.lengths.pitch, body[B::kChord]));
  c.Cn = n / (qS * length(subject.lengths.yaw, body[B::kSpan]));
  return c;
}

/// The same with the subject's constants.
template <typename Scalar>
[[nodiscard]] AeroCoefficients<Scalar> measured_coefficients(const FlightSample<Scalar>& s, const Subject& subject,
                                                             double rho, const Scalar& torque = Scalar(0.0)) {
  return measured_coefficients(s, subject, body_constants<Scalar>(subject), Scalar(rho), torque);
}

/// Moment coefficients per unit inertia, for an aircraft whose inertia is not known: Cl/Jx, Cm/Jy, Cn/Jz [1/(kg m^2)]
/// stand in `Cl`, `Cm`, `Cn`; the forces are as above.
///
/// The inertial coupling is that of a flat body, Jz = Jx + Jy, with Jxz = 0 and Jx = Jy:
///     Cl/Jx = (p' + q r)/(qbar S b),  Cm/Jy = (q' - p r)/(qbar S c),  Cn/Jz = r'/(qbar S b).
/// Moments of thrust, reaction torque and of an offset force cannot be taken out without the inertia; they stay in.
template <typename Scalar>
[[nodiscard]] AeroCoefficients<Scalar> coefficients_per_unit_inertia(const FlightSample<Scalar>& s,
                                                                     const Subject& subject, double rho) {
  using F = FlightSignal;
  AeroCoefficients<Scalar> c = measured_coefficients(s, subject, rho);
  const Scalar qS = Scalar(0.5 * rho * subject.wing_area) * s[F::kAirspeed] * s[F::kAirspeed];
  c.Cl = (s[F::kPdot] + s[F::kQ] * s[F::kR]) / (qS * Scalar(subject.roll_length()));
  c.Cm = (s[F::kQdot] - s[F::kP] * s[F::kR]) / (qS * Scalar(subject.pitch_length()));
  c.Cn = s[F::kRdot] / (qS * Scalar(subject.yaw_length()));
  return c;
}

/// What is regressed on: the measured coefficients, with moments per unit inertia where the subject has none.
template <typename Scalar>
[[nodiscard]] AeroCoefficients<Scalar> regressed_coefficients(const FlightSample<Scalar>& s, const Subject& subject,
                                                              double rho, const Scalar& torque = Scalar(0.0)) {
  return subject.inertia ? measured_coefficients(s, subject, rho, torque)
                         : coefficients_per_unit_inertia(s, subject, rho);
}

/// True of a moment of a subject without inertia.
[[nodiscard]] bool per_unit_inertia(Coefficient coefficient, const Subject& subject);
/// "Cl", or "Cl/Jx" per unit inertia.
[[nodiscard]] std::string regressed_name(Coefficient coefficient, const Subject& subject);
/// "Cl_beta", or "Cl/Jx_beta".
[[nodiscard]] std::string regressed_parameter_name(Coefficient coefficient, const Term& term, const Subject& subject);
/// "1/rad", or "1/rad/kg/m^2".
[[nodiscard]] std::string regressed_parameter_unit(Coefficient coefficient, const Term& term, const Subject& subject);

/// One of the six by its name.
template <typename Scalar>
[[nodiscard]] const Scalar& select(const AeroCoefficients<Scalar>& c, Coefficient which) {
  const EnumArray<Coefficient, const Scalar*, kCoefficients> all{{&c.CL, &c.CD, &c.CY, &c.Cl, &c.Cm, &c.Cn}};
  return *all[which];
}

/// A regression row [x, z] of one coefficient and how it reacts to errors of the flight signals.
struct CoefficientRow {
  Eigen::VectorXd row;       ///< n_p regressors, then the measured coefficient
  Eigen::MatrixXd jacobian;  ///< (n_p + 1) x kFlightSignals, d row / d signal
};

/// The row of a coefficient's model with its Jacobian by automatic differentiation: the error covariance of [x, z] is
/// J Sigma J' for signal errors of covariance Sigma.
[[nodiscard]] CoefficientRow coefficient_row(const CoefficientModel& model, const FlightSample<double>& sample,
                                             const Subject& subject, double rho);

}  // namespace veridyn::aircraft
