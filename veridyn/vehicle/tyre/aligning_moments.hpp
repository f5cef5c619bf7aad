#pragma once

#include <concepts>

#include "veridyn/vehicle/tyre/tyre_laws.hpp"
#include "veridyn/vehicle/tyre/wheel_arrays.hpp"

namespace veridyn::vehicle {

/// A tyre with `aligning_moment(tyre, load, slip_ratio, slip_angle, camber)`: the moment of the road on it about the
/// vertical axis through the contact point, to the left positive [N m]. It turns a rolling wheel back.
template <typename Tyre, typename Scalar>
concept HasAligningMoment = requires(const Tyre& tyre, const Scalar& number) {
  { aligning_moment(tyre, number, number, number, number) } -> std::convertible_to<Scalar>;
};

/// Those of the four wheels [N m]; 0 off the ground, and of tyres that have none. @param camber of all wheels [rad]
template <typename Tyre, typename Scalar>
[[nodiscard, gnu::noinline]] WheelArray<Scalar> aligning_moments(const PerWheel<Tyre>& tyres,
                                                                 const WheelArray<Scalar>& load,
                                                                 const WheelArray<Scalar>& slip_ratio,
                                                                 const WheelArray<Scalar>& slip_angle,
                                                                 const Scalar& camber) {
  WheelArray<Scalar> moment = WheelArray<Scalar>::Constant(Scalar(0.0));
  if constexpr (HasAligningMoment<Tyre, Scalar>) {
    for (std::size_t i = 0; i < kWheels; ++i) {
      if (load[i] > 0.0) moment[i] = aligning_moment(tyres[i], load[i], slip_ratio[i], slip_angle[i], camber);
    }
  }
  return moment;
}

}  // namespace veridyn::vehicle
