#pragma once

#include "veridyn/vehicle/model/vehicle.hpp"

namespace veridyn::vehicle {

/// The same vehicle with other numbers. Its tyres' cornering stiffness and friction follow C_f, C_r and mu by their
/// ratio to what they were (those of files by their scaling factors); longitudinal stiffness, shape and the load at
/// which a tyre was described stay, so that a heavier vehicle has the same tyres under more load.
/// @param to  admissible (`inadmissible`); mu stays infinite where it was
[[nodiscard]] Vehicle with_parameters(const Vehicle& vehicle, const VehicleParameters<double>& to);

}  // namespace veridyn::vehicle
