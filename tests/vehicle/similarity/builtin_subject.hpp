#pragma once

#include <string_view>

#include "veridyn/vehicle/model/builtin_vehicles.hpp"
#include "veridyn/vehicle/similarity/similarity.hpp"

namespace veridyn::vehicle::testing {

/// A built-in vehicle at the speed of its published drive.
inline SimilaritySubject subject_of(std::string_view name) {
  const BuiltinVehicle& vehicle = builtin_vehicle(name);
  return {.parameters = vehicle.parameters, .speed = vehicle.speed};
}

}  // namespace veridyn::vehicle::testing
