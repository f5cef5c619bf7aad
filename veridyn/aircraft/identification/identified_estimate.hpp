#pragma once

#include <span>
#include <vector>

#include "veridyn/aircraft/identification/fit/coefficient_result.hpp"
#include "veridyn/aircraft/identification/output_error/axis_output_error.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/estimation/result/estimate.hpp"

/// What was identified, as the subject of a simulation and as an estimate.
namespace veridyn::aircraft {

/// The subject with the identified values in its model; parameters of all other coefficients are unknown, so that
/// nothing can be simulated with what this flight does not support.
[[nodiscard]] Subject identified_subject(const Subject& subject, std::span<const CoefficientResult> results);

/// The coefficients that may be used.
[[nodiscard]] std::vector<Coefficient> identified_coefficients(std::span<const CoefficientResult> results);

/// The parameters of all coefficients, for estimate.json. Regressed coefficients share the errors of mass, geometry and
/// inertia; those of one axis by output error those of their run too.
/// @param runs  of output error, where that is the chosen method
[[nodiscard]] estimation::Estimate make_estimate(const Subject& subject, std::span<const CoefficientResult> results,
                                                 std::span<const AxisOutputError> runs = {});

}  // namespace veridyn::aircraft
