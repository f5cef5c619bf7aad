#include "veridyn/report/parts/open_loop_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/report/figures/curves.hpp"

namespace veridyn::report {
namespace {

using estimation::OpenLoop;
using estimation::OpenLoopState;
using estimation::OpenLoopWindow;

Table scores_table(const OpenLoop& open_loop) {
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
  for (const OpenLoopState& state : open_loop.states)
    table.rows.push_back(
        {.cells = {text_cell(state.name), number_cell(state.fit.rmse), text_cell(state.unit),
                   number_cell(state.normalised_rmse), number_cell(state.fit.theil),
                   number_cell(100.0 * state.shares.bias, 0), number_cell(100.0 * state.shares.variance, 0),
                   number_cell(100.0 * state.shares.covariance, 0), number_cell(100.0 * state.inside, 0),
                   number_cell(state.horizon_s, 1), text_cell(fmt::format("{} of {}", state.held, state.windows))}});
  return table;
}

/// The states of a group, window beside window.
TimeSeries states_figure(const OpenLoop& open_loop, const std::string& group) {
  TimeSeries figure{.title = group.empty() ? "Open loop, measured and predicted" : fmt::format("Open loop, {}", group),
                    .caption = fmt::format("The first {:g} s of each window, without a band, give its initial state; "
                                           "all else is forecast. Bands of 95 %: parameters, initial state and what is "
                                           "measured with errors.",
                                           open_loop.times.start_s)};
  for (const OpenLoopState& state : open_loop.states) {
    if (state.group != group) continue;
    if (figure.panels.empty()) figure.windows = windows_of(state.time);
    const double factor = estimation::shown_factor(state);
    Line model{.name = "model", .y = scaled(state.predicted, factor), .band = Band{}, .x = state.time};
    for (std::size_t k = 0; k < model.y.size(); ++k) {
      const double half = numerics::kNormal95 * factor * state.sigma[k];
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
Table windows_table(const OpenLoop& open_loop) {
  Table table{.title = "Windows",
              .caption =
                  "Added constants: what each window's first seconds ask for beyond the model, such as another "
                  "trim or bias. Horizon: of the state that leaves its band first."};
  const auto several = [&](std::string OpenLoopWindow::*name) {
    return std::ranges::any_of(open_loop.windows, [&](const OpenLoopWindow& w) { return !(w.*name).empty(); });
  };
  const bool recordings = several(&OpenLoopWindow::recording), groups = several(&OpenLoopWindow::group);
  if (recordings) table.columns.push_back({.name = "recording", .align = Align::kLeft});
  if (groups) table.columns.push_back({.name = "axis", .align = Align::kLeft});
  for (const char* name : {"from", "forecast from", "to", "horizon"})
    table.columns.push_back({.name = name, .unit = "s"});
  // Constants have no unit or one in SI; biases in rad are small numbers in deg.
  const auto added = [&](const OpenLoopWindow& w, std::size_t i) -> const estimation::SegmentParameter& {
    return w.start[w.start.size() - open_loop.offsets.size() + i];
  };
  for (std::size_t i = 0; i < open_loop.offsets.size(); ++i) {
    Column column{.name = fmt::format("added {}", open_loop.offsets[i]), .digits = 3};
    if (!open_loop.windows.empty()) {
      const std::string unit = estimation::shown_unit(added(open_loop.windows.front(), i).unit);
      if (unit != "1") column.unit = unit;
    }
    table.columns.push_back(std::move(column));
  }
  table.columns.push_back({.name = "", .align = Align::kLeft});
  for (const OpenLoopWindow& w : open_loop.windows) {
    Row row;
    if (recordings) row.cells.push_back(text_cell(w.recording));
    if (groups) row.cells.push_back(text_cell(w.group));
    for (const double t : {w.span.begin, w.forecast_from, w.span.end, w.first_left_s})
      row.cells.push_back(number_cell(t, 1));
    for (std::size_t i = 0; i < open_loop.offsets.size(); ++i)
      row.cells.push_back(number_cell(estimation::shown_factor(added(w, i).unit) * added(w, i).value));
    row.cells.push_back(text_cell(w.diverged ? "diverged" : ""));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

Section open_loop_section(const OpenLoop& open_loop) {
  Section section{.title = fmt::format("Open loop, from {}", open_loop.inputs), .id = "open_loop"};
  if (open_loop.text.empty()) return section;
  section.blocks.emplace_back(Paragraph{open_loop.text + ".", open_loop.available() ? Tone::kPlain : Tone::kNote});
  if (!open_loop.available()) return section;
  section.blocks.emplace_back(scores_table(open_loop));
  for (const std::string& group : open_loop.groups()) section.blocks.emplace_back(states_figure(open_loop, group));
  section.blocks.emplace_back(windows_table(open_loop));
  return section;
}

}  // namespace veridyn::report
