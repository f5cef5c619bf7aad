#pragma once

#include <span>

#include "veridyn/estimation/result/parameter.hpp"
#include "veridyn/vehicle/identification/options/drive_model_options.hpp"
#include "veridyn/vehicle/model/vehicle.hpp"

namespace veridyn::vehicle {

/// The parameters with what an estimate determines of them: C_f, C_r, I_z, the place of the centre of gravity on the
/// same wheelbase, mu. What was not excited stays as it was, but for mu: it was fitted together with the stiffnesses,
/// and one curve needs them all.
[[nodiscard]] VehicleParameters<double> estimated_parameters(VehicleParameters<double> vehicle,
                                                             std::span<const estimation::Parameter> parameters);

/// The vehicle with estimated_parameters, the relaxation length, and the tyres of an estimate: with `mu` Fiala's, with
/// `mu` and `C` (or a `model` whose tyres have it, held at its start) those of the reduced Magic Formula, otherwise
/// linear ones where a stiffness was excited.
[[nodiscard]] Vehicle estimated_vehicle(Vehicle vehicle, std::span<const estimation::Parameter> parameters,
                                        const DriveModelOptions& model);

}  // namespace veridyn::vehicle
