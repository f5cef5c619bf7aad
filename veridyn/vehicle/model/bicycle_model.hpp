#pragma once

#include <array>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"
#include "veridyn/vehicle/tyre/tyre.hpp"

namespace veridyn::vehicle {

/// How much geometry a bicycle model keeps.
enum class BicycleGeometry {
  kExact,       ///< slip angles with atan, forces of the front axle turned by delta
  kSmallAngles  ///< slip = (v + a r)/u, cos(delta) = 1: with linear tyres the linear bicycle model
};

/// Rates and forces at one moment.
template <typename Scalar>
struct BicycleRates {
  Scalar dv{0.0};                      ///< [m/s^2]
  Scalar dr{0.0};                      ///< [rad/s^2]
  Scalar lateral_acceleration{0.0};    ///< v' + r u, of the centre of gravity [m/s^2]
  std::array<Scalar, 2> slip_angle{};  ///< front, rear [rad]
  std::array<Scalar, 2> Fy{};          ///< of one tyre, front, rear [N]
};

/// The bicycle model: lateral velocity v and yaw rate r at a given forward speed u,
///
///     m (v' + r u) = 2 F_yf cos(delta) + 2 F_yr,   I_z r' = 2 a F_yf cos(delta) - 2 b F_yr
///     alpha_f = delta - atan((v + a r)/u),         alpha_r = -atan((v - b r)/u)
///
/// with tyre forces at the static loads and zero slip ratio (Milliken & Milliken 1995, chapter 5). No load transfer:
/// two tyres of an axle are equal. u must be > 0.
template <typename Scalar, typename Tyre>
struct BicycleModel {
  VehicleParameters<Scalar> parameters;
  Tyre front;
  Tyre rear;
  double gravity = kGravity;  ///< for the static loads [m/s^2]
  BicycleGeometry geometry = BicycleGeometry::kExact;

  /// At lateral velocity v and yaw rate r of the centre of gravity, steer of the road wheels [rad], forward speed u.
  [[nodiscard]] BicycleRates<Scalar> rates(const Scalar& v, const Scalar& r, const Scalar& steer,
                                           const Scalar& u) const {
    return rates_at_slips(slip_angles(v, r, steer, u), r, steer, u);
  }

  /// Slip angles of the front and the rear tyre [rad] in steady rolling; v is that of the contact points at the centre
  /// of gravity.
  [[nodiscard]] std::array<Scalar, 2> slip_angles(const Scalar& v, const Scalar& r, const Scalar& steer,
                                                  const Scalar& u) const {
    using std::atan;
    const Scalar slope_f = (v + parameters.a * r) / u;
    const Scalar slope_r = (v - parameters.b * r) / u;
    const bool exact = geometry == BicycleGeometry::kExact;
    return {exact ? Scalar(steer - atan(slope_f)) : Scalar(steer - slope_f),
            exact ? Scalar(-atan(slope_r)) : Scalar(-slope_r)};
  }

  /// The same at given slip angles, of tyres whose slip lags for example.
  [[nodiscard]] BicycleRates<Scalar> rates_at_slips(const std::array<Scalar, 2>& slip_angle, const Scalar& r,
                                                    const Scalar& steer, const Scalar& u) const {
    return rates_of_forces(slip_angle, tyre_forces(slip_angle), r, steer, u);
  }

  /// Of one tyre, front and rear, at the static loads [N].
  [[nodiscard]] std::array<Scalar, 2> tyre_forces(const std::array<Scalar, 2>& slip_angle) const {
    const PerWheel<Scalar> load = static_loads(parameters, gravity);
    const Scalar none(0.0);
    return {front.forces(load[kFrontLeft], none, slip_angle[0], none).Fy,
            rear.forces(load[kRearLeft], none, slip_angle[1], none).Fy};
  }

  /// The same where shares of the static loads have moved from one wheel of an axle to the other: mean of both [N].
  [[nodiscard]] std::array<Scalar, 2> tyre_forces(const std::array<Scalar, 2>& slip_angle,
                                                  const std::array<Scalar, 2>& moved) const {
    const PerWheel<Scalar> load = static_loads(parameters, gravity);
    const auto mean = [](const Tyre& tyre, const Scalar& at_rest, const Scalar& share, const Scalar& slip) -> Scalar {
      const Scalar none(0.0), more = at_rest * (1.0 + share), less = at_rest * (1.0 - share);
      return 0.5 * (tyre.forces(more, none, slip, none).Fy + tyre.forces(less, none, slip, none).Fy);
    };
    return {mean(front, load[kFrontLeft], moved[0], slip_angle[0]),
            mean(rear, load[kRearLeft], moved[1], slip_angle[1])};
  }

  /// The rates that forces of one tyre, front and rear, bring about; the slip angles only go with them.
  [[nodiscard]] BicycleRates<Scalar> rates_of_forces(const std::array<Scalar, 2>& slip_angle,
                                                     const std::array<Scalar, 2>& Fy, const Scalar& r,
                                                     const Scalar& steer, const Scalar& u) const {
    using std::cos;
    const VehicleParameters<Scalar>& p = parameters;
    BicycleRates<Scalar> out;
    out.slip_angle = slip_angle;
    out.Fy = Fy;
    const Scalar lateral_f = geometry == BicycleGeometry::kExact ? Scalar(out.Fy[0] * cos(steer)) : out.Fy[0];
    out.lateral_acceleration = 2.0 * (lateral_f + out.Fy[1]) / p.mass;
    out.dv = out.lateral_acceleration - r * u;
    out.dr = 2.0 * (p.a * lateral_f - p.b * out.Fy[1]) / p.I_z;
    return out;
  }
};

}  // namespace veridyn::vehicle
