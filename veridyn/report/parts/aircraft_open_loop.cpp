#include "veridyn/report/parts/aircraft_open_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/report/figures/curves.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::aircraft;

constexpr double kBandOf95 = 1.959963984540054;

double factor_of(const OpenLoopState& state) { return state.unit == "m/s" ? 1.0 : 1.0 / kDegree; }

Table scores_table(const OpenLoop& flown) {
  Table table{.title = "Open loop",
              .caption =
                  "Of what was forecast. RMSE / SD: over the standard deviation of what was measured (1 is no better "
                  "than its mean). Theil: inequality coefficient (0 perfect, 1 worst); bias, variance and covariance "
                  "are what its square is made of: an offset, a wrong gain, the rest. In band: share of the samples "
                  "within the 95 % band. Horizon: median time until the band is left, and in how many windows it "
                  "never was.",
              .columns = {{.name = "state", .align = Align::kLeft},
                          {.name = "RMSE", .digits = 3},
                          {.name = "unit", .align = Align::kLeft},
                          {.name = "RMSE / SD", .digits = 3},
                          {.name = "Theil", .digits = 3},
                          {.name = "bias", .unit = "%", .group = "of which"},
                          {.name = "variance", .unit = "%", .group = "of which"},
                          {.name = "covariance", .unit = "%", .group = "of which"},
                          {.name = "in band", .unit = "%"},
                          {.name = "horizon", .unit = "s"},
                          {.name = "held to the end"}}};
  for (const OpenLoopState& state : flown.states)
    table.rows.push_back(
        {.cells = {text_cell(state.name), number_cell(state.fit.rmse), text_cell(state.unit),
                   number_cell(state.normalised_rmse), number_cell(state.fit.theil),
                   number_cell(100.0 * state.shares.bias, 0), number_cell(100.0 * state.shares.variance, 0),
                   number_cell(100.0 * state.shares.covariance, 0), number_cell(100.0 * state.inside, 0),
                   number_cell(state.horizon_s, 1), text_cell(fmt::format("{} of {}", state.held, state.windows))}});
  return table;
}

/// The states of an axis, window beside window.
TimeSeries states_figure(const OpenLoop& flown, Axis axis) {
  TimeSeries figure{
      .title = fmt::format("Open loop, {}", to_string(axis)),
      .caption = fmt::format("The first {:g} s of each window, without a band, give its initial state; "
                             "all else is forecast. Bands of 95 %: parameters, initial state and sensors.",
                             flown.options.start_s)};
  for (const OpenLoopState& state : flown.states) {
    if (state.axis != axis) continue;
    if (figure.panels.empty()) figure.windows = windows_of(state.time);
    const double factor = factor_of(state);
    Line model{.name = "model", .y = scaled(state.predicted, factor), .band = Band{}, .x = state.time};
    for (std::size_t k = 0; k < model.y.size(); ++k) {
      const double half = kBandOf95 * factor * state.sigma[k];
      model.band->low.push_back(model.y[k] - half);
      model.band->high.push_back(model.y[k] + half);
    }
    Panel panel{.label = state.name, .unit = state.unit};
    panel.lines.push_back(
        {.name = "measured", .y = scaled(state.measured, factor), .x = state.time, .role = Role::kMeasured});
    panel.lines.push_back(std::move(model));
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

/// Each window with what was estimated of it besides the initial state.
Table windows_table(const OpenLoop& flown) {
  Table table{.title = "Windows",
              .caption =
                  "Added constants: what each window's first seconds ask for beyond the model, such as another "
                  "trim. Horizon: of the state that leaves its band first.",
              .columns = {{.name = "axis", .align = Align::kLeft},
                          {.name = "from", .unit = "s"},
                          {.name = "forecast from", .unit = "s"},
                          {.name = "to", .unit = "s"},
                          {.name = "horizon", .unit = "s"}}};
  const bool several = std::ranges::any_of(flown.windows, [](const OpenLoopWindow& w) { return !w.flight.empty(); });
  if (several) table.columns.insert(table.columns.begin(), {.name = "flight", .align = Align::kLeft});
  for (const Coefficient c : flown.offsets)
    table.columns.push_back({.name = fmt::format("added {}", name_of(c)), .digits = 3});
  table.columns.push_back({.name = "", .align = Align::kLeft});
  for (const OpenLoopWindow& w : flown.windows) {
    Row row;
    if (several) row.cells.push_back(text_cell(w.flight));
    row.cells.push_back(text_cell(to_string(w.axis)));
    for (const double t : {w.span.begin, w.forecast_from, w.span.end}) row.cells.push_back(number_cell(t, 1));
    row.cells.push_back(number_cell(w.first_left_s, 1));
    for (std::size_t i = 0; i < flown.offsets.size(); ++i)
      row.cells.push_back(number_cell(w.start[w.start.size() - flown.offsets.size() + i].value));
    row.cells.push_back(text_cell(w.diverged ? "diverged" : ""));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

Section open_loop_section(const FlightAnalysis& analysis) {
  const OpenLoop& flown = analysis.open_loop;
  Section section{.title = "Open loop, from deflections and thrust", .id = "open_loop"};
  if (flown.text.empty()) return section;
  section.blocks.emplace_back(Paragraph{flown.text + ".", flown.available() ? Tone::kPlain : Tone::kNote});
  if (!flown.available()) return section;
  section.blocks.emplace_back(scores_table(flown));
  for (const Axis axis : {Axis::kLongitudinal, Axis::kLateral}) {
    TimeSeries figure = states_figure(flown, axis);
    if (!figure.panels.empty()) section.blocks.emplace_back(std::move(figure));
  }
  section.blocks.emplace_back(windows_table(flown));
  return section;
}

}  // namespace veridyn::report
