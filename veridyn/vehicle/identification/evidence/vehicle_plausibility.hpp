#pragma once

#include <span>
#include <vector>

#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/estimation/result/parameter.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"

namespace veridyn::vehicle {

/// Are the values those of a vehicle? Yaw inertia against m a b (about 1 for cars, Dixon 1996, sec. 1.8), cornering
/// stiffness of an axle over its static load (about 10 to 20 per rad), friction, understeer as an angle per g: with
/// care outside what vehicles have, failed far outside, both beyond three standard errors. Rows are about one parameter
/// each.
/// @param known  mass, a and b of it are used
[[nodiscard]] std::vector<estimation::Evidence> plausibility(std::span<const estimation::Parameter> parameters,
                                                             const VehicleParameters<double>& known);

/// A row, failed, about each parameter whose search ended at a bound: it says so itself, or its standard error is zero
/// to rounding.
[[nodiscard]] std::vector<estimation::Evidence> bound_rows(std::span<const estimation::Parameter> parameters);

}  // namespace veridyn::vehicle
