#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "veridyn/aircraft/flying_qualities/levels.hpp"
#include "veridyn/aircraft/identification/fit/coefficient_result.hpp"
#include "veridyn/aircraft/model/trim.hpp"
#include "veridyn/estimation/result/derived_quantity.hpp"
#include "veridyn/estimation/result/estimate.hpp"

namespace veridyn::aircraft {

/// The natural modes of the identified aircraft in straight flight (`flight_modes`) and their levels (`level_of`), for
/// estimate.json: `short_period.frequency`, `.damping`, `.time_to_half` (or `.time_to_double`), `.level` and so on,
/// `short_period.load_factor_per_alpha` and `.control_anticipation`.
///
/// Intervals are 2.5 % and 97.5 % of the modes of a thousand parameter vectors drawn from the estimate's covariance,
/// which holds what is not known of the sensors too; mass, geometry and inertia are drawn with the parameters that they
/// gave, since their errors cancel here, and `SpeedEffects` with them: `thrust` between -1 and 2, `lift` 0 +- 0.2. NaN
/// where more than 2.5 % of them have no such mode. A coefficient of which a derivative was not excited counts as not
/// known.
/// @param identified  with the identified values, the rest unknown
/// @param results  what became of each coefficient
[[nodiscard]] std::vector<estimation::DerivedQuantity> derived_modes(const Subject& identified,
                                                                     std::span<const CoefficientResult> results,
                                                                     const estimation::Estimate& estimate,
                                                                     const Trim& flown, const FlyingQualities& asked,
                                                                     std::uint64_t seed);

}  // namespace veridyn::aircraft
