#pragma once

#include "veridyn/vehicle/model/four_wheel_model.hpp"

/// The four-wheel model on the tyres of this library, compiled once in four_wheel_models.cpp: whoever includes this
/// header does not compile it again.
namespace veridyn::vehicle {

extern template class FourWheelModel<double, LinearTyre<double>>;
extern template class FourWheelModel<double, FialaTyre<double>>;
extern template class FourWheelModel<double, SimpleMagicFormulaTyre<double>>;
extern template class FourWheelModel<double, MagicFormulaTyre<double>>;

}  // namespace veridyn::vehicle
