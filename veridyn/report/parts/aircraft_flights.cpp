#include "veridyn/report/parts/aircraft_flights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "veridyn/core/constants.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::aircraft;

Table recordings_table(const FlightAnalysis& analysis) {
  Table table{
      .title = "Recordings",
      .caption =
          "Each is reconstructed by itself: its own wind, delays and errors of sensors. Figures of all show them "
          "one after the other, each from the time in the last column.",
      .columns = {{.name = "Recording"},
                  {.name = "Log"},
                  {.name = "Use"},
                  {.name = "Recorded", .unit = "s"},
                  {.name = "Longitudinal", .unit = "s"},
                  {.name = "Lateral", .unit = "s"},
                  {.name = "In the figures from", .unit = "s"}}};
  for (std::size_t i = 0; i < analysis.flights.size(); ++i) {
    const PreparedFlight& flight = analysis.flights[i];
    const auto& uses = analysis.estimate.recordings;
    const TimeSpan span = flight.aligned.recording.span();
    table.rows.push_back(
        {.cells = {text_cell(flight.name), text_cell(flight.aligned.log_kind),
                   text_cell(i < uses.size() ? uses[i].use : std::string()), number_cell(span.duration(), 0),
                   number_cell(flight.segments.longitudinal.excited_s(), 0),
                   number_cell(flight.segments.lateral.excited_s(), 0), number_cell(span.begin + flight.shift_s, 0)}});
  }
  return table;
}

Table manoeuvres_table(std::span<const PreparedFlight> flights) {
  Table table{.title = "Manoeuvres",
              .caption = "Times on the clock of the recording.",
              .columns = {{.name = "Recording"},
                          {.name = "Axis"},
                          {.name = "Use"},
                          {.name = "From", .unit = "s"},
                          {.name = "To", .unit = "s"}}};
  for (const PreparedFlight& flight : flights) {
    for (const AxisSegments* axis : {&flight.segments.longitudinal, &flight.segments.lateral}) {
      for (const auto& [use, spans] :
           {std::pair("identification", &axis->identification), std::pair("hold-out", &axis->holdout)}) {
        for (const TimeSpan& span : *spans)
          table.rows.push_back({.cells = {text_cell(flight.name), text_cell(to_string(axis->axis)), text_cell(use),
                                          number_cell(span.begin, 1), number_cell(span.end, 1)}});
      }
    }
  }
  return table;
}

Table scores_table(const estimation::Estimate& estimate) {
  Table table{.title = "Prediction, recording by recording",
              .columns = {{.name = "Recording"},
                          {.name = "Quantity"},
                          {.name = "RMSE", .digits = 3},
                          {.name = "Unit"},
                          {.name = "R2", .digits = 3}}};
  for (const estimation::RecordingUse& recording : estimate.recordings) {
    for (const auto& [name, v] : recording.validation)
      table.rows.push_back({.cells = {text_cell(recording.name), text_cell(name), number_cell(v.rmse),
                                      text_cell(v.unit), number_cell(v.r2)}});
  }
  return table;
}

/// The parameters of a coefficient: of all flights, and of each by itself.
Table parameters_table(const CoefficientResult& result) {
  Table table{
      .title = fmt::format("{}, flight by flight", result.name),
      .caption = result.scatter->found()
                     ? "The flights differ by more than their error bars: what is estimated is their mean, with "
                       "an interval from their scatter."
                     : "",
      .columns = {{.name = "Parameter"},
                  {.name = "Recording"},
                  {.name = "Value", .digits = 4},
                  {.name = "Sigma", .digits = 2},
                  {.name = "Between flights", .digits = 2}}};
  for (std::size_t j = 0; j < result.chosen->parameters.size(); ++j) {
    const estimation::Parameter& p = result.chosen->parameters[j];
    const Eigen::VectorXd& between = result.scatter->between_sigma;
    const double scatter = between.size() > 0 ? between(j) : kNaN;
    table.rows.push_back({.cells = {text_cell(p.name), text_cell("all"), number_cell(p.value), number_cell(p.sigma),
                                    number_cell(scatter)}});
    for (const FlightEstimate& flight : result.flight_estimates) {
      const estimation::Parameter* one = estimation::find_parameter(flight.parameters, p.name);
      if (one != nullptr)
        table.rows.push_back({.cells = {text_cell(""), text_cell(flight.flight), number_cell(one->value),
                                        number_cell(one->sigma), number_cell(kNaN)}});
    }
  }
  return table;
}

}  // namespace

Section flights_section(const FlightAnalysis& analysis) {
  Section section{.title = "The recordings", .id = "recordings", .folded = true};
  if (analysis.flights.size() < 2) return section;
  section.blocks.emplace_back(recordings_table(analysis));
  section.blocks.emplace_back(manoeuvres_table(analysis.flights));
  if (Table scores = scores_table(analysis.estimate); !scores.rows.empty())
    section.blocks.emplace_back(std::move(scores));
  for (const CoefficientResult& result : analysis.coefficients) {
    const bool shown = result.verdict == estimation::GroupVerdict::kIdentified && result.chosen && result.scatter;
    if (shown) section.blocks.emplace_back(parameters_table(result));
  }
  return section;
}

}  // namespace veridyn::report
