#include "veridyn/vehicle/identification/fit/vehicle_estimate.hpp"

#include <algorithm>

namespace veridyn::vehicle {

const estimation::Parameter* VehicleEstimate::find(std::string_view name) const {
  return estimation::find_parameter(parameters, name);
}

const VehicleEstimate* find_estimate(std::span<const VehicleEstimate> estimates, VehicleMethod method) {
  for (const VehicleEstimate& e : estimates) {
    if (e.method == method) return &e;
  }
  return nullptr;
}

double understeer_gradient(const VehicleParameters<double>& p) {
  return 0.5 * p.mass / p.wheelbase() * (p.b / p.C_f - p.a / p.C_r);
}

}  // namespace veridyn::vehicle
