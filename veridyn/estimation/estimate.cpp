#include "veridyn/estimation/estimate.hpp"

namespace veridyn::estimation {

const Parameter* Estimate::find(std::string_view name) const { return find_parameter(parameters, name); }

}  // namespace veridyn::estimation
