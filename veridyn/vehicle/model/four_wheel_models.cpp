#include "veridyn/vehicle/model/four_wheel_models.hpp"

namespace veridyn::vehicle {

template class FourWheelModel<double, LinearTyre<double>>;
template class FourWheelModel<double, FialaTyre<double>>;
template class FourWheelModel<double, SimpleMagicFormulaTyre<double>>;
template class FourWheelModel<double, MagicFormulaTyre<double>>;

}  // namespace veridyn::vehicle
