#include "apps/veridyn/live/camera_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace veridyn::app {
namespace {

using namespace veridyn::report;
using camera::Calibration;
using camera::CalibrationPoints;
using camera::TrackCamera;

/// Residuals as lines from the points, drawn so much longer that the largest is a twentieth of the track.
XYPlot residual_plot(const CalibrationPoints& points, const Calibration& c) {
  Eigen::Vector2d low = points.points.front().track, high = low;
  double largest = 0.0;
  for (std::size_t i = 0; i < points.points.size(); ++i) {
    low = low.cwiseMin(points.points[i].track);
    high = high.cwiseMax(points.points[i].track);
    largest = std::max(largest, c.residuals[i].track.norm());
  }
  const double wanted = (high - low).maxCoeff() / 20.0 / std::max(largest, 1e-9);
  const double factor = std::pow(10.0, std::floor(std::log10(std::max(wanted, 1.0))));
  // More lines than these are a blot, and a figure that has to thin them out joins what is left.
  constexpr std::size_t kMostDrawn = 900;
  const std::size_t every = (points.points.size() + kMostDrawn - 1) / kMostDrawn;
  XYPlot plot{.title = "Residuals on the track",
              .caption = fmt::format("From {} to where its image is mapped, {:g} times as long. Noise points "
                                     "everywhere; lines that agree with their neighbours are an error of the map.",
                                     every > 1 ? fmt::format("one point in {}", every) : "each point", factor),
              .x = {.label = "x", .unit = "m"},
              .y = {.label = "y", .unit = "m"},
              .equal_scale = true,
              .height = 480};
  XYSeries arrows{.name = fmt::format("residual x {:g}", factor), .style = Style::kLine, .width = 1.0};
  XYSeries dots{.name = "point", .role = Role::kMeasured, .width = 2.0};
  for (std::size_t i = 0; i < points.points.size(); i += every) {
    const Eigen::Vector2d& from = points.points[i].track;
    const Eigen::Vector2d to = from + factor * c.residuals[i].track;
    // NaN breaks the line.
    for (const Eigen::Vector2d& p : {from, to, Eigen::Vector2d(Eigen::Vector2d::Constant(std::nan("")))}) {
      arrows.x.push_back(p(0));
      arrows.y.push_back(p(1));
    }
    dots.x.push_back(from(0));
    dots.y.push_back(from(1));
  }
  plot.series = {std::move(dots), std::move(arrows)};
  return plot;
}

Table parameter_table(const Calibration& c) {
  constexpr std::array kNames{"h0", "h1", "h2", "h3", "h4", "h5", "h6", "h7", "centre x", "centre y", "k1", "k2"};
  Table table{.title = "Parameters",
              .caption = fmt::format("u = (p - ({:.6g}, {:.6g}) m) / {:.6g} m, r in units of {:.6g} px; docs/camera.md "
                                     "has the equations. Standard errors take errors of the points as independent.",
                                     c.camera.track_centre()(0), c.camera.track_centre()(1), c.camera.track_scale(),
                                     c.camera.image_scale())};
  table.columns = {{.name = "parameter", .align = Align::kLeft},
                   {.name = "value"},
                   {.name = "standard error"},
                   {.name = "unit", .align = Align::kLeft}};
  const TrackCamera::Parameters sigma = c.sigma();
  for (int i = 0; i < TrackCamera::kParameters; ++i) {
    if (i >= 8 && !c.distorted) break;
    table.rows.push_back(
        {.cells = {text_cell(kNames[i]), measured_cell(c.camera.parameters()(i), sigma(i)),
                   measured_cell(sigma(i), sigma(i)), text_cell(i < 6 || i == 8 || i == 9 ? "px" : "")}});
  }
  return table;
}

}  // namespace

Document calibration_report(const CalibrationPoints& points, const Calibration& c,
                            const std::optional<camera::HeldOut>& held_out, const std::vector<CheckOutcome>& checks,
                            const std::string& generator) {
  Document document{.title = "Calibration of a camera", .subtitle = points.source};
  const bool good = std::all_of(checks.begin(), checks.end(), [](const CheckOutcome& check) { return check.passed; });
  document.verdict = {
      .level = good ? Level::kGood : Level::kCaution,
      .headline = fmt::format(
          "{} points, {:.2f} mm RMS on the track{}.", c.points, 1e3 * c.rms_track,
          held_out ? fmt::format("; {:.2f} mm on the half that was held out", 1e3 * held_out->rms_held_out) : "")};
  Section section{.title = "What could make it wrong"};
  Table table;
  table.columns = {{.name = "check", .align = Align::kLeft}, {.name = "found", .align = Align::kLeft}};
  table.sortable = false;
  for (const CheckOutcome& check : checks)
    table.rows.push_back(
        {.cells = {status_cell(check.passed ? Status::kGood : Status::kCaution), text_cell(check.text)}});
  section.blocks.push_back(std::move(table));
  document.sections = {std::move(section),
                       {.title = "Residuals", .blocks = {residual_plot(points, c)}},
                       {.title = "The map", .blocks = {parameter_table(c)}}};
  document.generator = generator;
  return document;
}

}  // namespace veridyn::app
