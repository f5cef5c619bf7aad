#pragma once

#include <span>

#include "veridyn/estimation/parameter.hpp"
#include "veridyn/vehicle/model/vehicle.hpp"

namespace veridyn::vehicle {

/// The vehicle with what an estimate determines of it: C_f, C_r, I_z, the place of the centre of gravity, the
/// relaxation length, and its tyres: with `mu` Fiala's, with `mu` and `C` those of the reduced Magic Formula. What was
/// not excited stays as the vehicle has it.
[[nodiscard]] Vehicle estimated_vehicle(Vehicle vehicle, std::span<const estimation::Parameter> parameters);

}  // namespace veridyn::vehicle
