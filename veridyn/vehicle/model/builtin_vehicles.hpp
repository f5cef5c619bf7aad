#pragma once

#include <span>
#include <string>
#include <string_view>

#include "veridyn/vehicle/model/suspension.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"

namespace veridyn::vehicle {

/// A vehicle that needs no file.
struct BuiltinVehicle {
  std::string name;
  std::string description;
  VehicleParameters<double> parameters;
  double speed = 20.0;  ///< at which it is driven in the published example [m/s]
  AxleSuspension suspension_f{}, suspension_r{};
};

/// - "reference": the full-size car of the reference manoeuvre, 1100 kg at 20 m/s;
/// - "reference_1to5": the published model of one fifth its size, 8.8 kg at 4 m/s, with its rounded tyre stiffnesses
///   (100 and 200 N/rad where exact similarity needs 96 and 192) and roll inertia;
/// - "saloon": no car that exists, but one as they are: 1500 kg, wheelbase 2.7 m, understeer gradient 2.7 deg/g, roll
///   gradient 5.5 deg/g, with roll centres, roll steer and compliance steer of their usual sizes. Our own numbers.
[[nodiscard]] std::span<const BuiltinVehicle> builtin_vehicles();

/// @throws InputError at `place` with the nearest name.
[[nodiscard]] const BuiltinVehicle& builtin_vehicle(std::string_view name, std::string_view place = "vehicle");

}  // namespace veridyn::vehicle
