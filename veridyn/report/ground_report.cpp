#include "veridyn/report/ground_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/report/figures/curves.hpp"
#include "veridyn/report/parts/estimate_tables.hpp"
#include "veridyn/report/parts/remarks.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::aircraft;

constexpr const char* kSwingMethod =
    "Bifilar: I = m g d^2/(4 w^2 L). Pendulum: I = m g l/w^2 about the pivot. The cradle alone is taken off, and a "
    "pendulum's inertia moved to the aircraft's own centre of gravity (parallel axis). The air that swings with a "
    "light "
    "wing counts as inertia here: it is not taken off.";

Table inertia_table(const SwingTestResult& result) {
  Table table{.title = "Moments of inertia",
              .caption =
                  "95 % interval by Monte Carlo (JCGM 101). By source: linear standard deviations of what was measured "
                  "by hand, and of the frequencies by the scatter of the runs. Largest term: of the difference that "
                  "gives the value; the larger it is, the less the difference means.",
              .columns = {{.name = "Moment"},
                          {.name = "Verdict"},
                          {.name = "Value", .unit = "kg m^2"},
                          {.name = "Sigma", .unit = "kg m^2"},
                          {.name = "95 % low", .group = "interval"},
                          {.name = "95 % high", .group = "interval"},
                          {.name = "masses", .digits = 2, .group = "sigma by source"},
                          {.name = "filar distance", .digits = 2, .group = "sigma by source"},
                          {.name = "lengths", .digits = 2, .group = "sigma by source"},
                          {.name = "frequencies", .digits = 2, .group = "sigma by source"},
                          {.name = "Largest term", .unit = "kg m^2", .digits = 3}}};
  for (const AxisInertia& i : result.axes) {
    const bool good = i.verdict == InertiaVerdict::kDetermined;
    const double sigma = i.sigma();
    table.rows.push_back(
        {.cells = {text_cell(fmt::format("J{}", i.test.axis)),
                   status_cell(good ? Status::kGood : Status::kBad, good ? "determined" : "not determined"),
                   measured_cell(i.value, sigma), measured_cell(sigma, sigma),
                   measured_cell(i.value - i.error.high, sigma), measured_cell(i.value - i.error.low, sigma),
                   number_cell(i.by_mass), number_cell(i.by_filar_distance), number_cell(i.by_length),
                   number_cell(i.by_frequency), number_cell(i.largest_term)},
         .status = good ? Status::kGood : Status::kBad});
  }
  return table;
}

Table run_table(const SwingTestResult& result) {
  Table table{
      .title = "Runs",
      .caption =
          "Fit of e^(-s t) (a cos w t + b sin w t) + c to the free swing. Sigma of the frequency from the "
          "residual, its autocorrelation allowed for; what counts is the scatter of the runs where it is larger.",
      .columns = {{.name = "Run"},
                  {.name = "Axis"},
                  {.name = "What hung"},
                  {.name = "Undamped frequency", .unit = "rad/s"},
                  {.name = "Sigma", .unit = "rad/s", .digits = 2},
                  {.name = "Decay", .unit = "1/s", .digits = 3},
                  {.name = "Amplitude", .unit = "deg", .digits = 3},
                  {.name = "Residual", .unit = "deg", .digits = 2},
                  {.name = "Cycles", .digits = 3},
                  {.name = "Main axis", .unit = "%", .digits = 3},
                  {.name = "Result"}}};
  for (const AxisInertia& i : result.axes) {
    for (const SwingRun& run : i.runs) {
      const auto& f = run.fit;
      table.rows.push_back(
          {.cells = {text_cell(run.file), text_cell(std::string(1, i.test.axis)),
                     text_cell(run.cradle_alone ? "cradle alone" : "aircraft"), number_cell(f.undamped_frequency(), 4),
                     number_cell(f.sigma_frequency), number_cell(f.decay), number_cell(f.amplitude() / kDegree),
                     number_cell(f.residual_rms / kDegree), number_cell(f.cycles()),
                     number_cell(100.0 * run.swing.principal_share),
                     status_cell(f.usable() ? Status::kGood : Status::kBad, to_string(f.end))},
           .status = f.usable() ? Status::kNone : Status::kBad});
    }
  }
  return table;
}

TimeSeries decay_figure(const SwingRun& run) {
  TimeSeries figure{.title = run.file, .axis = run.file};
  Line measured{.name = "measured", .role = Role::kMeasured}, fit{.name = "damped cosine"};
  const std::size_t count = run.swing.time.size();
  const std::size_t step = std::max<std::size_t>(1, count / 3000);
  for (std::size_t i = 0; i < count; i += step) {
    figure.samples.push_back(run.swing.time[i]);
    measured.y.push_back(run.swing.angle[i] / kDegree);
    const bool fitted = run.fit.usable() && i >= run.begin && i < run.end;
    fit.y.push_back(fitted ? run.fit(run.swing.time[i]) / kDegree : std::nan(""));
  }
  figure.panels.push_back({.label = "angle", .unit = "deg", .lines = {std::move(measured), std::move(fit)}});
  return figure;
}

/// Radians are shown as degrees.
struct ShownUnit {
  double factor;
  std::string name;
};

ShownUnit shown_unit_of(const SensorFit& fit) {
  if (fit.unit == "rad") return {1.0 / kDegree, "deg"};
  return {1.0, fit.unit};
}

Table calibration_table() {
  Table table{.title = "Scale and bias",
              .caption =
                  "raw = bias + scale true. rms, worst: of corrected readings against the reference. Hysteresis: mean "
                  "residual of rising less falling points. Bend: what a quadratic term amounts to at the ends; p: that "
                  "it is nothing.",
              .columns = {{.name = "Channel"},
                          {.name = "Method"},
                          {.name = "Points"},
                          {.name = "value", .group = "scale"},
                          {.name = "sigma", .group = "scale"},
                          {.name = "value", .group = "bias"},
                          {.name = "sigma", .group = "bias"},
                          {.name = "rms", .digits = 3, .group = "residual"},
                          {.name = "worst", .digits = 3, .group = "residual"},
                          {.name = "white p", .digits = 2, .group = "residual"},
                          {.name = "Hysteresis", .digits = 2},
                          {.name = "Bend", .digits = 2},
                          {.name = "Bend p", .digits = 2},
                          {.name = "Unit"}}};
  return table;
}

Row calibration_row(const SensorFit& fit) {
  const SensorCalibration& c = fit.calibration;
  const auto [unit, name] = shown_unit_of(fit);
  const double sigma_scale = std::sqrt(c.covariance(0, 0)), sigma_bias = unit * std::sqrt(c.covariance(1, 1));
  return {.cells = {text_cell(c.channel), text_cell(method_text(fit)),
                    number_cell(static_cast<double>(fit.raw.size()), 0), measured_cell(c.scale, sigma_scale),
                    measured_cell(sigma_scale, sigma_scale), measured_cell(unit * c.bias, sigma_bias),
                    measured_cell(sigma_bias, sigma_bias), number_cell(unit * fit.rms), number_cell(unit * fit.worst),
                    number_cell(fit.whiteness.p_value), number_cell(unit * fit.hysteresis),
                    number_cell(unit * fit.bend), number_cell(fit.quadratic_p), text_cell(name)},
          .status = !fit.usable            ? Status::kBad
                    : fit.findings.empty() ? Status::kGood
                                           : Status::kCaution};
}

/// Readings with their line, and what it leaves.
std::array<XYPlot, 2> calibration_plots(const SensorFit& fit) {
  const SensorCalibration& c = fit.calibration;
  const auto [unit, name] = shown_unit_of(fit);
  XYPlot points{.title = fmt::format("{}: reading against reference", c.channel),
                .x = {.label = "reference", .unit = name},
                .y = {.label = "raw", .unit = name}};
  XYPlot left{.title = fmt::format("{}: residual", c.channel),
              .x = {.label = "reference", .unit = name},
              .y = {.label = "corrected less reference", .unit = name}};
  XYSeries raw{.name = "points"}, line{.name = "fit", .style = Style::kLine};
  XYSeries rising{.name = "rising"}, falling{.name = "falling", .role = Role::kMeasured};
  for (std::size_t i = 0; i < fit.raw.size(); ++i) {
    raw.x.push_back(unit * fit.reference[i]);
    raw.y.push_back(unit * fit.raw[i]);
    XYSeries& side = fit.direction[i] < 0 ? falling : rising;
    side.x.push_back(unit * fit.reference[i]);
    side.y.push_back(unit * fit.residual[i]);
  }
  const auto [low, high] = std::minmax_element(fit.reference.begin(), fit.reference.end());
  for (const double x : {*low, *high}) {
    line.x.push_back(unit * x);
    line.y.push_back(unit * (c.bias + c.scale * x));
  }
  points.series = {std::move(raw), std::move(line)};
  left.series = {std::move(rising)};
  if (!falling.x.empty()) left.series.push_back(std::move(falling));
  left.guides.push_back({.direction = Guide::Direction::kHorizontal, .value = 0.0});
  return {std::move(points), std::move(left)};
}

}  // namespace

Document swing_test_report(const SwingTest& test, const SwingTestResult& result, const std::string& program) {
  Document document = started_document(fmt::format("{}: inertia from swing tests", test.name),
                                       "Bifilar suspension and compound pendulum", program);
  const auto good = std::count_if(result.axes.begin(), result.axes.end(),
                                  [](const AxisInertia& i) { return i.verdict == InertiaVerdict::kDetermined; });
  const auto all = signed_index(result.axes.size());
  document.verdict.level = good == all ? Level::kGood : good == 0 ? Level::kBad : Level::kCaution;
  document.verdict.word = good == all ? "Determined" : good == 0 ? "Not determined" : "Partly determined";
  document.verdict.headline = result.estimate.verdict + ".";
  for (const AxisInertia& i : result.axes) document.verdict.lines.push_back(i.reason);
  document.facts = {
      {"Mass", fmt::format("{:g} kg", test.mass)},
      {"Cradle", fmt::format("{:g} kg", test.cradle_mass)},
      {"Standard errors", fmt::format("{:g} g, {:g} mm between the lines, {:g} mm of lengths", 1e3 * test.sigma_mass,
                                      1e3 * test.sigma_filar_distance, 1e3 * test.sigma_length)},
      {"Draws", std::to_string(test.draws)}};
  Section results{.title = "Moments of inertia", .id = "inertia"};
  results.blocks.emplace_back(inertia_table(result));
  Paragraph method;
  method.text = kSwingMethod;
  results.blocks.emplace_back(std::move(method));
  document.sections.push_back(std::move(results));
  Section runs{.title = "Runs", .id = "runs", .folded = true};
  runs.blocks.emplace_back(run_table(result));
  for (const AxisInertia& i : result.axes) {
    for (const SwingRun& run : i.runs) runs.blocks.emplace_back(decay_figure(run));
  }
  document.sections.push_back(std::move(runs));
  add_warnings(document, result.warnings);
  return document;
}

Document calibration_report(const CalibrationStudy& study, const CalibrationResult& result,
                            const std::string& program) {
  Document document = started_document(fmt::format("{}: calibration of air-data sensors", study.name),
                                       "From wind-tunnel points", program);
  const bool failed =
      std::any_of(result.sensors.begin(), result.sensors.end(), [](const auto& f) { return !f.usable; });
  const bool clean = result.estimate.warnings.empty();
  document.verdict.level = failed ? Level::kBad : clean ? Level::kGood : Level::kCaution;
  document.verdict.word = failed ? "Failed" : clean ? "Calibrated" : "With reservations";
  document.verdict.headline = result.estimate.verdict + ".";
  document.verdict.lines = result.estimate.warnings;
  document.facts = {{"Points", study.file.filename().string()}};
  Section results{.title = "Calibration", .id = "calibration"};
  Table table = calibration_table();
  Section figures{.title = "Points", .id = "points", .folded = true};
  for (const SensorFit& fit : result.sensors) {
    table.rows.push_back(calibration_row(fit));
    for (XYPlot& plot : calibration_plots(fit)) figures.blocks.emplace_back(std::move(plot));
  }
  results.blocks.emplace_back(std::move(table));
  document.sections.push_back(std::move(results));
  document.sections.push_back(std::move(figures));
  add_warnings(document, result.estimate.warnings);
  return document;
}

}  // namespace veridyn::report
