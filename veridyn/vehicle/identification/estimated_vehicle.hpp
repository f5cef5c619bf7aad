#pragma once

#include <span>

#include "veridyn/estimation/parameter.hpp"
#include "veridyn/vehicle/identification/drive_model_options.hpp"
#include "veridyn/vehicle/model/vehicle.hpp"

namespace veridyn::vehicle {

/// The vehicle with what an estimate determines of it: C_f, C_r, I_z, the place of the centre of gravity, the
/// relaxation length, and its tyres: with `mu` Fiala's, with `mu` and `C` (or a `model` whose tyres have it, held at
/// its start) those of the reduced Magic Formula. What was not excited stays as the vehicle has it, but for mu, C and
/// E: they were fitted together with the stiffnesses, and one curve needs them all.
[[nodiscard]] Vehicle estimated_vehicle(Vehicle vehicle, std::span<const estimation::Parameter> parameters,
                                        const DriveModelOptions& model);

}  // namespace veridyn::vehicle
