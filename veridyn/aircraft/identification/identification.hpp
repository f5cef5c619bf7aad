#pragma once

#include <span>
#include <vector>

#include "veridyn/aircraft/identification/evidence/checked_flight.hpp"
#include "veridyn/aircraft/identification/fit/coefficient_result.hpp"
#include "veridyn/aircraft/identification/options/identify_options.hpp"
#include "veridyn/aircraft/identification/output_error/axis_output_error.hpp"
#include "veridyn/aircraft/identification/rows/prepared_flight.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct.hpp"
#include "veridyn/core/progress.hpp"

namespace veridyn::aircraft {

/// What identification found.
struct Identification {
  std::vector<CoefficientResult> coefficients;
  std::vector<AxisOutputError> output_error;  ///< of both axes, where that is the chosen method
};

/// Estimates every coefficient of `subject.model` on its axis's segments of all flights together. Regressor errors are
/// propagated from the signals' noise by automatic differentiation; the variance of z that they leave unexplained is
/// equation error. The checks of the recordings bear on the coefficients too. With `choose_output_error` the estimates
/// of output error are taken and judged in place of the regressions that they start from; what mass, geometry, inertia
/// and air data leave in doubt is then still found by regression.
[[nodiscard]] Identification identify_coefficients(std::span<const PreparedFlight> flights, const Subject& subject,
                                                   const IdentifyOptions& options, Progress& progress);

/// Of a flight whose reconstruction ended at a contradiction: every coefficient that would have been identified,
/// skipped for it; `evidence` are the rows of the
/// recording.
[[nodiscard]] std::vector<CoefficientResult> not_identified(const Subject& subject, const IdentifyOptions& options,
                                                            const Contradiction& contradiction,
                                                            std::span<const estimation::Evidence> evidence);

}  // namespace veridyn::aircraft
