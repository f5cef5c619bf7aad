#include "veridyn/vehicle/model/vehicle_parameters.hpp"

#include <fmt/format.h>

#include <string_view>

#include "veridyn/core/constants.hpp"

namespace veridyn::vehicle {

std::string inadmissible(const VehicleParameters<double>& p) {
  for (std::size_t i = 0; i < kVehicleFields.size(); ++i) {
    const std::string_view name = kVehicleFields[i].name;
    const double value = field_of(p, i);
    // A free body needs no damper, no bar, and may have its centre of gravity on the road: the limit of the bicycle.
    const bool may_be_zero =
        name == "C_sf" || name == "C_sr" || name == "K_bf" || name == "K_br" || name == "cg_height";
    const bool may_be_infinite = name == "mu";
    if (!(may_be_zero ? value >= 0.0 : value > 0.0)) {
      const std::string unit = may_be_infinite ? "" : fmt::format(" {}", kVehicleFields[i].unit);
      return fmt::format("{} is {:g}{}; must be {}", name, value, unit, may_be_zero ? ">= 0" : "> 0");
    }
    if (!may_be_infinite && !(value < kInfinity)) {
      return fmt::format("{} is infinite", name);
    }
  }
  if (!(4.0 * p.unsprung_mass < p.mass)) {
    return fmt::format("unsprung_mass is {:g} kg a wheel; four must be lighter than the vehicle's mass of {:g} kg",
                       p.unsprung_mass, p.mass);
  }
  return {};
}

}  // namespace veridyn::vehicle
