#include "veridyn/aircraft/identification/output_error/axis_output_error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "veridyn/aircraft/identification/options/identify_options.hpp"
#include "veridyn/aircraft/identification/output_error/output_error_model.hpp"

namespace veridyn::aircraft {
namespace {

/// The segments of the flights whose motion is known.
std::vector<OutputErrorModel::FlownSpans> flown_spans(std::span<const PreparedFlight> flights, Axis axis, RowUse use,
                                                      const IdentifyOptions& options) {
  std::vector<OutputErrorModel::FlownSpans> flown;
  for (const PreparedFlight& flight : flights) {
    if (!flight.usable()) continue;
    const bool gusts = options.output_error_gusts.value_or(flight.signals.over_ground);
    flown.push_back({flight.signals, spans_of(flight.segments.of(axis), use), gusts, flight.name});
  }
  return flown;
}

estimation::OutputErrorOptions options_for(const OutputErrorModel& model, const IdentifyOptions& options) {
  estimation::OutputErrorOptions o;
  o.significance = options.significance;
  o.max_relaxations = 40;
  // Beyond a hundredth of an error bar, further digits are not worth simulating a long flight once more.
  o.tolerance = 0.01;
  if (options.output_error_biases) {
    for (const estimation::ModelOutput& output : model.outputs()) {
      // Only biases of the accelerometers: that of a freely integrated state is not distinguishable from its initial
      // value.
      if (output.name.starts_with("accel")) o.output_biases.push_back(output.name);
    }
  }
  return o;
}

}  // namespace

AxisOutputError axis_output_error(Axis axis, std::span<const PreparedFlight> flights, RowUse use,
                                  const Subject& subject, std::vector<CoefficientModel> models,
                                  const IdentifyOptions& options, Progress& progress) {
  AxisOutputError run;
  run.axis = axis;
  std::vector<std::string> names;
  for (const CoefficientModel& model : models) {
    run.coefficients.push_back(model.coefficient);
    names.emplace_back(name_of(model.coefficient));
  }
  const std::string label = fmt::format("output error, {}", to_string(axis));
  const std::vector<OutputErrorModel::FlownSpans> flown = flown_spans(flights, axis, use, options);
  if (models.empty() || flown.empty()) {
    run.text = fmt::format("{}: not tried, regression gave no coefficient to start from", label);
    return run;
  }
  const OutputErrorModel model(flown, subject, models);
  if (model.segments() == 0) {
    run.text = fmt::format("{}: not tried, no segment of at least 2 s has all signals", label);
    return run;
  }
  run.attempted = true;
  run.estimate = estimation::output_error(model, model.measured(), options_for(model, options), progress);
  run.text = fmt::format("{} ({}): {}", label, fmt::join(names, ", "), run.estimate.message);
  return run;
}

}  // namespace veridyn::aircraft
