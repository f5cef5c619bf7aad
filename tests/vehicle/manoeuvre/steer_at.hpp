#pragma once

#include "veridyn/vehicle/manoeuvre/manoeuvre.hpp"

namespace veridyn::vehicle::testing {

/// The steer angle of a manoeuvre at a time.
inline double steer(const Manoeuvre& m, double time) { return m.driver->controls(time).steer; }

}  // namespace veridyn::vehicle::testing
