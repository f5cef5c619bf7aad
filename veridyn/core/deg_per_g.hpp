#pragma once

#include "veridyn/core/constants.hpp"

namespace veridyn {

/// A gradient over lateral acceleration [rad/(m/s^2)], of steer or roll, in the unit that engineers of vehicles read:
/// degrees per standard gravity.
[[nodiscard]] constexpr double deg_per_g(double gradient) { return gradient * kGravity / kDegree; }

}  // namespace veridyn
