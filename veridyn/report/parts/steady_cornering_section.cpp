#include "veridyn/report/parts/steady_cornering_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/deg_per_g.hpp"
#include "veridyn/report/figures/curves.hpp"
#include "veridyn/vehicle/simulation/steady_turn.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::vehicle;

/// What a turn shows over its lateral acceleration, with the line whose slope is the gradient.
XYPlot gradient_figure(const std::string& title, const std::string& label, const TurnSamples& turn,
                       const std::vector<double>& shown, const TurnGradient& gradient) {
  XYPlot plot{.title = title,
              .x = {"lateral acceleration", "g"},
              .y = {label, "deg"},
              .series = {{.name = "driven",
                          .x = scaled(turn.acceleration, 1.0 / kGravity),
                          .y = scaled(shown, 1.0 / kDegree),
                          .style = Style::kLine,
                          .width = 2.0}},
              .height = 260};
  if (!std::isfinite(gradient.slope)) return plot;
  const double most = *std::ranges::max_element(turn.acceleration);
  XYSeries line{
      .name = fmt::format("{:.2f} deg/g", deg_per_g(gradient.slope)), .role = Role::kReference, .style = Style::kLine};
  for (const double a : {kGentlestTurn, std::min(kSharpestGentleTurn, most)}) {
    line.x.push_back(a / kGravity);
    line.y.push_back((gradient.intercept + gradient.slope * a) / kDegree);
  }
  plot.series.push_back(std::move(line));
  return plot;
}

}  // namespace

Section steady_cornering_section(const SimulationStudy& study, const SimulationRun& run) {
  Section section{.title = "Steady cornering"};
  Table table{.title = "Understeer and roll",
              .caption =
                  "Steer beyond the Ackermann angle L/R, and roll, per lateral acceleration. Positive: the car "
                  "understeers, and leans to the outside.",
              .columns = {{.name = "gradient", .align = Align::kLeft},
                          {.name = "value", .unit = "deg/g", .digits = 3},
                          {.name = "SI", .unit = "rad s^2/m", .digits = 3},
                          {.name = "of", .align = Align::kLeft}}};
  const auto add = [&](const char* name, double gradient, const std::string& of) {
    if (std::isfinite(gradient))
      table.rows.push_back(
          {.cells = {text_cell(name), number_cell(deg_per_g(gradient)), number_cell(gradient), text_cell(of)}});
  };
  const double begin = steady_turn_begin(study.manoeuvre);
  const TurnSamples turn = steady_turn(run.trajectory, study.vehicle.parameters.wheelbase(), begin);
  const TurnGradient steer = turn_gradient(turn.acceleration, turn.extra_steer);
  const TurnGradient roll = turn.roll.empty() ? TurnGradient{} : turn_gradient(turn.acceleration, turn.roll);
  const std::string drive =
      fmt::format("this drive, over {:g} to {:g} m/s^2 (ISO 4138)", kGentlestTurn, kSharpestGentleTurn);
  add("understeer", steer.slope, drive);
  if (run.cornering) add("understeer", run.cornering->understeer_gradient, "the four-wheel model in gentle turns");
  add("understeer", run.characteristics.understeer_gradient, "the linear bicycle: tyres and weight alone");
  add("roll", roll.slope, drive);
  if (run.cornering) add("roll", run.cornering->roll_gradient, "the four-wheel model in gentle turns");
  section.blocks.emplace_back(std::move(table));
  if (turn.acceleration.empty()) return section;
  section.blocks.emplace_back(gradient_figure("Understeer diagram", "steer - L r/u", turn, turn.extra_steer, steer));
  if (!turn.roll.empty())
    section.blocks.emplace_back(gradient_figure("Roll diagram", "roll to the outside", turn, turn.roll, roll));
  return section;
}

}  // namespace veridyn::report
