#pragma once

#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::aircraft {

/// Where thrust comes from.
enum class PropulsionKind {
  kNone,        ///< no engine, or thrust is a channel of the recording
  kPolynomial,  ///< thrust [N] as a polynomial in throttle and airspeed
  kMomentum,    ///< T = rho/2 S_prop C_prop ((k_motor throttle)^2 - Va^2), not below 0 (Beard & McLain 2012, eq. 4.15)
  kPropeller,   ///< map of a propeller: T = rho n^2 D^4 CT(J), Q = rho n^2 D^5 CP(J) / (2 pi), J = Va / (n D)
};

/// Thrust along body x [N] and the reaction torque about body x [N m].
template <typename Scalar>
struct PropulsionLoad {
  Scalar thrust{0.0};
  Scalar torque{0.0};
};

/// One term value * throttle^throttle_power * Va^airspeed_power of a thrust polynomial [N, m/s].
struct ThrustTerm {
  int throttle_power = 0;
  int airspeed_power = 0;
  double value = 0.0;
  friend bool operator==(const ThrustTerm&, const ThrustTerm&) = default;
};

/// The engine. Thrust acts along body x at `position`.
struct Propulsion {
  PropulsionKind kind = PropulsionKind::kNone;
  std::array<double, 3> position = {0.0, 0.0, 0.0};  ///< from the centre of gravity, body axes [m]

  // kPolynomial
  std::vector<ThrustTerm> polynomial;  ///< the sum is taken as 0 when negative

  // kMomentum
  double S_prop = 0.0;   ///< swept area [m^2]
  double C_prop = 1.0;   ///< efficiency [-]
  double k_motor = 0.0;  ///< exit speed of the air at full throttle [m/s]
  double k_tp = 0.0;     ///< torque constant [N m s^2]: torque = -k_tp (k_omega throttle)^2
  double k_omega = 0.0;  ///< rotor speed at full throttle [rad/s]

  // kPropeller; the rotor follows throttle * omega_max with a first-order lag
  double diameter = 0.0;       ///< [m]
  double omega_max = 0.0;      ///< rotor speed at full throttle [rad/s]
  double time_constant = 0.1;  ///< of the rotor [s]
  std::vector<double> CT;      ///< thrust coefficient, powers of J from 0
  std::vector<double> CP;      ///< power coefficient, powers of J from 0
  double J_max = 10.0;         ///< the map ends here; larger advance ratios are taken as J_max [-]
  double rotation = 1.0;       ///< +1: the rotor turns clockwise seen from behind, torque on the body is -

  /// Rotor speed in the steady state [rad/s]; 0 for kinds without a rotor.
  template <typename Scalar>
  [[nodiscard]] Scalar steady_rotor_speed(const Scalar& throttle) const;
  /// Thrust and torque at an airspeed along body x [m/s] (Va cos(alpha) cos(beta)), called Va in the formulas above.
  /// `rotor_speed` [rad/s] is used by kPropeller only. Does not throw or allocate.
  template <typename Scalar>
  [[nodiscard]] PropulsionLoad<Scalar> load(const Scalar& throttle, const Scalar& axial_speed, const Scalar& rho,
                                            const Scalar& rotor_speed) const;

  friend bool operator==(const Propulsion&, const Propulsion&) = default;
};

/// Study table `[subject.propulsion]`; with a `kind` that is not the object's it starts from nothing.
[[nodiscard]] const KeyTable<Propulsion>& propulsion_keys();
/// That table.
[[nodiscard]] std::string write_propulsion_toml(const Propulsion& propulsion,
                                                std::string_view heading = "subject.propulsion");

// ---------------------------------------------------------------------------------------------------------------------

template <typename Scalar>
Scalar Propulsion::steady_rotor_speed(const Scalar& throttle) const {
  if (kind == PropulsionKind::kPropeller) return Scalar(omega_max) * throttle;
  if (kind == PropulsionKind::kMomentum) return Scalar(k_omega) * throttle;
  return Scalar(0.0);
}

template <typename Scalar>
PropulsionLoad<Scalar> Propulsion::load(const Scalar& throttle, const Scalar& axial_speed, const Scalar& rho,
                                        const Scalar& rotor_speed) const {
  const auto horner = [](const std::vector<double>& c, const Scalar& x) {
    Scalar sum(0.0);
    for (std::size_t i = c.size(); i-- > 0;) sum = sum * x + Scalar(c[i]);
    return sum;
  };
  PropulsionLoad<Scalar> out;
  switch (kind) {
    case PropulsionKind::kNone:
      break;
    case PropulsionKind::kPolynomial: {
      Scalar sum(0.0);
      for (const ThrustTerm& term : polynomial) {
        Scalar product(term.value);
        for (int i = 0; i < term.throttle_power; ++i) product *= throttle;
        for (int i = 0; i < term.airspeed_power; ++i) product *= axial_speed;
        sum += product;
      }
      if (sum > Scalar(0.0)) out.thrust = sum;
      break;
    }
    case PropulsionKind::kMomentum: {
      const Scalar exit = Scalar(k_motor) * throttle;
      const Scalar thrust = Scalar(0.5 * S_prop * C_prop) * rho * (exit * exit - axial_speed * axial_speed);
      if (thrust > Scalar(0.0)) out.thrust = thrust;
      const Scalar omega = Scalar(k_omega) * throttle;
      out.torque = Scalar(-k_tp) * omega * omega;
      break;
    }
    case PropulsionKind::kPropeller: {
      const Scalar n = rotor_speed / Scalar(2.0 * kPi);
      if (!(n > Scalar(1e-6))) break;  // a stopped rotor: J is undefined and n^2 CT(J_max) has no meaning
      Scalar J = axial_speed / (n * Scalar(diameter));
      if (J > Scalar(J_max)) J = Scalar(J_max);
      const double D2 = diameter * diameter;
      out.thrust = rho * n * n * Scalar(D2 * D2) * horner(CT, J);
      out.torque = Scalar(-rotation * D2 * D2 * diameter / (2.0 * kPi)) * rho * n * n * horner(CP, J);
      break;
    }
  }
  return out;
}

}  // namespace veridyn::aircraft
