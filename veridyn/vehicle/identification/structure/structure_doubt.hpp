#pragma once

#include <optional>
#include <span>

#include "veridyn/estimation/judgement/judgement.hpp"
#include "veridyn/vehicle/identification/fit/vehicle_estimate.hpp"
#include "veridyn/vehicle/identification/structure/tried_structure.hpp"

namespace veridyn::vehicle {

/// By how much the estimate of another structure moves what both have.
[[nodiscard]] StructureDoubt structure_doubt(DriveStructure structure, double probability, const VehicleEstimate& other,
                                             const VehicleEstimate& taken);

/// The estimate with what other structures leave in doubt: their differences, by their probabilities, are a part of the
/// covariance, so that an interval reaches to what each of them would give.
[[nodiscard]] VehicleEstimate with_doubt(VehicleEstimate estimate, std::span<const StructureDoubt> doubts,
                                         double significance);

/// One standard deviation of a parameter that the doubts leave [its unit].
[[nodiscard]] double doubt_of(std::span<const StructureDoubt> doubts, std::string_view parameter);

/// What the doubts add to intervals: nothing where no other structure was left open, a note while they stay below the
/// standard errors of `estimate`, which has them, else with care.
[[nodiscard]] std::optional<estimation::Evidence> doubt_row(std::span<const StructureDoubt> doubts,
                                                            const VehicleEstimate& estimate);

}  // namespace veridyn::vehicle
