#pragma once

#include <cmath>

#include "veridyn/numerics/trigonometry.hpp"
#include "veridyn/vehicle/model/four_wheel_options.hpp"
#include "veridyn/vehicle/model/four_wheel_state.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"

namespace veridyn::vehicle {

/// What the driver's controls do at the wheels: steer of the front ones, by the Ackermann share of the options turned
/// about a common centre, and torques by the shares of the axles, half on each side. Torques are 0 without
/// longitudinal dynamics.
template <typename Scalar>
[[nodiscard, gnu::flatten]] WheelControls<Scalar> controls_at_wheels(const VehicleParameters<Scalar>& p,
                                                                     const FourWheelOptions& options,
                                                                     const Scalar& steer, double drive_torque,
                                                                     double brake_torque) {
  using std::atan2;
  using std::tan;
  WheelControls<Scalar> out;
  const Scalar none(0.0), one(1.0);
  Scalar left = steer, right = steer;
  if (options.ackermann != 0.0) {
    // The wheel's axis through the turning centre, which lies L/tan(steer) to the left of the rear axle's middle.
    const Scalar slope = tan(steer), across = p.track_f / (2.0 * p.wheelbase()) * slope;
    left += options.ackermann * (atan2(slope, Scalar(1.0 - across)) - steer);
    right += options.ackermann * (atan2(slope, Scalar(1.0 + across)) - steer);
  }
  out.steer << left, right, none, none;
  out.cos.setConstant(one);
  out.sin.setConstant(none);
  if (options.geometry == BicycleGeometry::kExact) {
    const numerics::SineCosine<Scalar> at_left = numerics::sine_cosine(left);
    const numerics::SineCosine<Scalar> at_right = options.ackermann == 0.0 ? at_left : numerics::sine_cosine(right);
    out.cos << at_left.cos, at_right.cos, one, one;
    out.sin << at_left.sin, at_right.sin, none, none;
  }
  out.drive.setZero();
  out.brake.setZero();
  if (options.longitudinal) {
    const LongitudinalParameters& l = *options.longitudinal;
    const double drive_f = 0.5 * l.front_drive_share * drive_torque, drive_r = 0.5 * drive_torque - drive_f;
    const double brake_f = 0.5 * l.front_brake_share * brake_torque, brake_r = 0.5 * brake_torque - brake_f;
    out.drive << drive_f, drive_f, drive_r, drive_r;
    out.brake << brake_f, brake_f, brake_r, brake_r;
  }
  return out;
}

}  // namespace veridyn::vehicle
