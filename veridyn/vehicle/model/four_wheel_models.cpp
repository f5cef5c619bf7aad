#include "veridyn/vehicle/model/four_wheel_models.hpp"

namespace veridyn::vehicle {

// NOLINTNEXTLINE(bugprone-macro-parentheses): the name of a template takes none
#define VERIDYN_FOUR_WHEELS_ON(Tyre) template class FourWheelModel<double, Tyre<double>>;
VERIDYN_TYRE_LAWS(VERIDYN_FOUR_WHEELS_ON)
#undef VERIDYN_FOUR_WHEELS_ON

}  // namespace veridyn::vehicle
