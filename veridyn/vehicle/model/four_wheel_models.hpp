#pragma once

#include "veridyn/vehicle/model/four_wheel_model.hpp"

/// The four-wheel model on the tyres of this library, compiled once in four_wheel_models.cpp: whoever includes this
/// header does not compile it again.
namespace veridyn::vehicle {

// NOLINTNEXTLINE(bugprone-macro-parentheses): the name of a template takes none
#define VERIDYN_FOUR_WHEELS_ON(Tyre) extern template class FourWheelModel<double, Tyre<double>>;
VERIDYN_TYRE_LAWS(VERIDYN_FOUR_WHEELS_ON)
#undef VERIDYN_FOUR_WHEELS_ON

}  // namespace veridyn::vehicle
