#pragma once

#include <span>
#include <vector>

#include "veridyn/aircraft/identification/fit/coefficient_result.hpp"
#include "veridyn/aircraft/identification/options/identify_options.hpp"
#include "veridyn/aircraft/identification/rows/prepared_flight.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/estimation/result/estimate.hpp"

namespace veridyn::aircraft {

/// An estimate from elsewhere against all excited segments of these flights: a coefficient is identified when it
/// explains at least `min_holdout_r2` of the measured one there, else rejected. Parameters that the estimate rejected
/// are not tried.
/// @throws InputError when the estimate has no parameter that the subject's model names.
[[nodiscard]] std::vector<CoefficientResult> evaluate_estimate(std::span<const PreparedFlight> flights,
                                                               const Subject& subject, const IdentifyOptions& options,
                                                               const estimation::Estimate& estimate);

}  // namespace veridyn::aircraft
