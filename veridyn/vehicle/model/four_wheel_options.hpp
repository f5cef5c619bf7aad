#pragma once

#include <optional>

#include "veridyn/core/constants.hpp"
#include "veridyn/vehicle/model/bicycle_model.hpp"
#include "veridyn/vehicle/model/longitudinal.hpp"
#include "veridyn/vehicle/model/suspension.hpp"

namespace veridyn::vehicle {

/// Which equations of motion.
enum class FourWheelConvention {
  /// From first principles, the default: the sprung mass moves in heave and gravity tilts it; energy is conserved.
  kFirstPrinciples,
  /// The similarity study whose curves `veridyn reproduce vehicle` draws again: the whole mass in heave and four
  /// unsprung masses in addition; vertical forces are deviations from the static load, so that gravity does not tilt
  /// the body and tyres may pull; contact points do not move with roll and pitch.
  kSource
};

/// What of the four-wheel model can be chosen.
struct FourWheelOptions {
  FourWheelConvention convention = FourWheelConvention::kFirstPrinciples;
  /// kSmallAngles: slip angle delta - V_y/V_x and forces not turned by delta.
  BicycleGeometry geometry = BicycleGeometry::kExact;
  double gravity = kGravity;  ///< [m/s^2]
  /// 0: both front wheels steered equally; 1: Ackermann, their axes meet on the line of the rear axle. Between: linear.
  double ackermann = 0.0;
  double camber_per_roll = 0.0;  ///< inclination of the wheels as a share of the body's roll
  /// Distance rolled in which the slip angle follows by 63 % [m]; 0: at once.
  double relaxation_length = 0.0;
  /// How the axles guide their wheels, and springs by table; first principles only where it is more than the springs.
  AxleSuspension suspension_f{}, suspension_r{};
  /// First principles only.
  AerodynamicLift lift{};
  /// The tyres' aligning moments turn the vehicle too; needs a tyre that has one.
  bool aligning_moment = false;
  /// Without: u stays as it is, at the cost of `FourWheelRates::holding_force`, and wheels roll freely.
  std::optional<LongitudinalParameters> longitudinal{};

  /// Throws InputError("vehicle", ...) naming the first option that makes no sense.
  void validate() const;
};

}  // namespace veridyn::vehicle
