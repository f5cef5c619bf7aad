#include "veridyn/report/parts/drive_path_section.hpp"

#include "veridyn/core/constants.hpp"
#include "veridyn/report/figures/curves.hpp"

namespace veridyn::report {
namespace {

using vehicle::DrivePath;

Table errors_table(const DrivePath& path) {
  Table table{.title = "Heading and path",
              .caption =
                  "Of what was forecast. At the end: median over the windows, whose median way is in the last "
                  "column. Across: what the position's error has across the simulated path, which is the "
                  "model's; along it the recorded speed's error adds up.",
              .columns = {{.name = "quantity", .align = Align::kLeft},
                          {.name = "RMSE", .digits = 3},
                          {.name = "at the end", .digits = 3},
                          {.name = "unit", .align = Align::kLeft},
                          {.name = "way", .unit = "m"}}};
  const auto add = [&](const char* name, double rmse, double at_end, const char* unit) {
    table.rows.push_back({.cells = {text_cell(name), number_cell(rmse), number_cell(at_end), text_cell(unit),
                                    number_cell(path.distance_m, 0)}});
  };
  if (path.heading) add("heading", path.heading->rmse / kDegree, path.heading->at_end / kDegree, "deg");
  if (path.position) {
    add("position", path.position->rmse, path.position->at_end, "m");
    add("of which across", path.across_rmse, kNaN, "m");
  }
  return table;
}

XYPlot path_plot(const DrivePath& path) {
  XYPlot plot{.title = "Open loop, path",
              .caption = "The model's path is laid on the recorded one in the first seconds of each window.",
              .x = {"x", "m"},
              .y = {"y", "m"},
              .equal_scale = true,
              .height = 380};
  plot.series.push_back({.name = "measured", .x = path.x, .y = path.y, .role = Role::kMeasured, .style = Style::kLine});
  plot.series.push_back({.name = "model", .x = path.x_model, .y = path.y_model, .style = Style::kLine});
  return plot;
}

TimeSeries heading_figure(const DrivePath& path) {
  TimeSeries figure{.title = "Open loop, heading"};
  Panel panel{.label = "heading", .unit = "deg"};
  panel.lines.push_back(
      {.name = "measured", .y = scaled(path.yaw, 1.0 / kDegree), .x = path.time, .role = Role::kMeasured});
  panel.lines.push_back({.name = "model", .y = scaled(path.yaw_model, 1.0 / kDegree), .x = path.time});
  figure.panels.push_back(std::move(panel));
  return figure;
}

}  // namespace

Section drive_path_section(const DrivePath& path) {
  Section section{.title = "Open loop, heading and path", .id = "open_loop_path"};
  if (!path.available()) return section;
  section.blocks.emplace_back(errors_table(path));
  if (path.heading) section.blocks.emplace_back(heading_figure(path));
  if (path.position) section.blocks.emplace_back(path_plot(path));
  return section;
}

}  // namespace veridyn::report
