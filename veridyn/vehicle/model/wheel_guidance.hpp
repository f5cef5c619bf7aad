#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <cstddef>

#include "veridyn/core/error.hpp"
#include "veridyn/vehicle/model/suspension.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"
#include "veridyn/vehicle/tyre/wheel_arrays.hpp"

namespace veridyn::vehicle {

/// What the suspension of both axles does to the four wheels but for springs of constant rate, dampers and bars, with
/// the coefficients of each wheel worked out once. With travel t (bump positive), y to the left, W the track:
///
/// - Roll centre at height h: a contact point moves sideways by `scrub` = +-2 h/W (left +) per travel, and by virtual
///   work the links push its wheel up, and the body down, by `scrub` times the lateral force. The body rolls about that
///   height, so that corners rise by (c - h)/2 roll^2 to second order instead of c/2 roll^2.
/// - Steer: roll_steer (t_right - t_left)/W on both wheels, toe-in of bump_steer t on each.
/// - Compliance: c F_y of each wheel (`compliance_steer`).
template <typename Scalar>
class WheelGuidance {
 public:
  using Wheels = WheelArray<Scalar>;

  /// Of springs only.
  WheelGuidance() = default;
  /// @param stiffness of the tyres at rest [N/rad] @param spring_loads of the corners at rest [N]
  /// Throws InputError("vehicle", ...) where compliance times stiffness is 0.9 or more, of either sign.
  WheelGuidance(const VehicleParameters<Scalar>& p, const AxleSuspension& front, const AxleSuspension& rear,
                const Wheels& stiffness, const Wheels& spring_loads);

  [[nodiscard]] bool has_roll_centres() const { return has_roll_centres_; }
  [[nodiscard]] const Wheels& roll_centre() const { return roll_centre_; }  ///< [m]
  [[nodiscard]] const Wheels& scrub() const { return scrub_; }              ///< [1]
  /// Of gravity's tilting moment, what the roll centres take off it [N m/rad].
  [[nodiscard]] const Scalar& tilting() const { return tilting_; }

  [[nodiscard]] bool has_curves() const { return !curve_f_.empty() || !curve_r_.empty(); }
  /// Forces of the springs that are tables [N], in place of those in `springs`.
  [[gnu::noinline]] void replace_springs(const Wheels& travel, Wheels& springs) const;
  /// Travel of a wheel's spring under a force [m]; `rate` is that of one that is no table.
  [[nodiscard]] Scalar travel_at(Eigen::Index wheel, const Scalar& rate, const Scalar& force) const;

  /// By travel and roll [rad].
  [[nodiscard]] bool steers() const { return steers_; }
  [[nodiscard, gnu::noinline]] Wheels steer(const Wheels& travel) const;

  [[nodiscard]] bool yields() const { return yields_; }
  [[nodiscard]] const Wheels& compliance() const { return compliance_; }  ///< [rad/N]
  [[nodiscard]] const Wheels& yielding() const { return yielding_; }      ///< times the tyres' stiffness at rest [1]

 private:
  [[nodiscard]] const SpringCurve& curve(Eigen::Index wheel) const { return wheel < 2 ? curve_f_ : curve_r_; }

  bool has_roll_centres_ = false, steers_ = false, yields_ = false;
  SpringCurve curve_f_, curve_r_;
  Wheels roll_centre_, scrub_, per_difference_, per_travel_, compliance_, yielding_;
  Scalar tilting_{0.0};
};

template <typename Scalar>
WheelGuidance<Scalar>::WheelGuidance(const VehicleParameters<Scalar>& p, const AxleSuspension& front,
                                     const AxleSuspension& rear, const Wheels& stiffness, const Wheels& spring_loads)
    : curve_f_(front.spring), curve_r_(rear.spring) {
  for (std::size_t i = 0; i < kWheels; ++i) {
    const AxleSuspension& axle = is_front(i) ? front : rear;
    const Scalar& track = is_front(i) ? p.track_f : p.track_r;
    const double side = is_left(i) ? 1.0 : -1.0;
    roll_centre_[i] = Scalar(axle.roll_centre);
    scrub_[i] = side * 2.0 * axle.roll_centre / track;
    per_difference_[i] = axle.roll_steer / track;
    per_travel_[i] = Scalar(-side * axle.bump_steer);
    compliance_[i] = Scalar(axle.compliance_steer);
    yielding_[i] = axle.compliance_steer * stiffness[i];
    if (!(yielding_[i] < 0.9 && yielding_[i] > -0.9)) {
      throw InputError("vehicle", fmt::format("compliance_steer_{} is {:g} rad/N; times the tyre's cornering stiffness "
                                              "it must be between -0.9 and 0.9",
                                              is_front(i) ? "f" : "r", axle.compliance_steer));
    }
    has_roll_centres_ = has_roll_centres_ || axle.roll_centre != 0.0;
    steers_ = steers_ || axle.roll_steer != 0.0 || axle.bump_steer != 0.0;
    yields_ = yields_ || axle.compliance_steer != 0.0;
  }
  tilting_ = sum_of_wheels<Scalar>(roll_centre_ * spring_loads);
}

template <typename Scalar>
void WheelGuidance<Scalar>::replace_springs(const Wheels& travel, Wheels& springs) const {
  for (Eigen::Index i = 0; i < 4; ++i) {
    if (!curve(i).empty()) springs[i] = curve(i).template force<Scalar>(travel[i]);
  }
}

template <typename Scalar>
Scalar WheelGuidance<Scalar>::travel_at(Eigen::Index wheel, const Scalar& rate, const Scalar& force) const {
  return curve(wheel).empty() ? Scalar(force / rate) : curve(wheel).travel_at(force);
}

template <typename Scalar>
auto WheelGuidance<Scalar>::steer(const Wheels& travel) const -> Wheels {
  const Scalar front = travel[1] - travel[0], rear = travel[3] - travel[2];  // roll against the axle, times the track
  const Wheels difference(front, front, rear, rear);
  return per_difference_ * difference + per_travel_ * travel;
}

}  // namespace veridyn::vehicle
