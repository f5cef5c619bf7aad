#pragma once

#include <Eigen/Core>

#include "veridyn/vehicle/tyre/wheels.hpp"

namespace veridyn::vehicle {

/// A number for each of the four wheels, to calculate with: element by element, vectorised for double.
template <typename Scalar>
using WheelArray = Eigen::Array<Scalar, 4, 1>;

/// The sum over the wheels, first of left and right of each axle: the same to the last bit when they are exchanged.
template <typename Scalar>
[[nodiscard]] inline Scalar sum_of_wheels(const WheelArray<Scalar>& x) {
  return (x[0] + x[1]) + (x[2] + x[3]);
}

}  // namespace veridyn::vehicle
