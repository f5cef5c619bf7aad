#pragma once

#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/result/parameter.hpp"
#include "veridyn/estimation/uncertainty/profile_likelihood.hpp"
#include "veridyn/vehicle/identification/fit/vehicle_estimates.hpp"

namespace veridyn::vehicle {

/// C_f, C_r and I_z are followed no further than to a tenth and ten times where their search began: beyond that no car
/// is, and the steps of the integration are too long.
inline constexpr double kProfileReach = 10.0;

/// Profile likelihood of the unknowns `problem.options.profiles` about a drive's output-error estimate, its noise
/// fitted again at every point as the estimate does it. The statistic is divided by what widens the error bars: each
/// parameter's variance with autocorrelated residuals over that with white ones, and `widening` (1: none), the factor
/// of parts of the drive that scatter. What `[identify.uncertainty]` adds is not in it.
[[nodiscard]] estimation::ProfileResult profile_drive(const VehicleProblem& problem,
                                                      const EquationErrorEstimates* equation_error,
                                                      const OutputErrorResult& output_error, double widening,
                                                      Progress& progress);

}  // namespace veridyn::vehicle
