#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/aircraft/identification/rows/flight_rows.hpp"
#include "veridyn/aircraft/identification/rows/prepared_flight.hpp"
#include "veridyn/aircraft/identification/signals/segments.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"

namespace veridyn::aircraft {

struct IdentifyOptions;

/// Output error on the segments of one axis.
struct AxisOutputError {
  Axis axis = Axis::kLongitudinal;
  std::vector<Coefficient> coefficients;  ///< whose parameters were estimated together
  bool attempted = false;
  estimation::OutputErrorEstimate estimate;
  std::string text;  ///< one sentence: what came out, or why it was not tried
};

/// Flies the coefficients of one axis together over its segments of all flights and moves their parameters until the
/// motion fits. Each segment has its own initial state (and, with `output_error_biases`, its own biases), in its own
/// flight's wind.
/// @param models  of this axis, with values to start from
[[nodiscard]] AxisOutputError axis_output_error(Axis axis, std::span<const PreparedFlight> flights, RowUse use,
                                                const Subject& subject, std::vector<CoefficientModel> models,
                                                const IdentifyOptions& options, Progress& progress);

}  // namespace veridyn::aircraft
