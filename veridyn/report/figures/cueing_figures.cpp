#include "veridyn/report/figures/cueing_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace veridyn::report {

using namespace veridyn::cueing;

double shown(Cue cue, double value) { return cue < Cue::kRoll ? value : value / kDegree; }
const char* shown_unit(Cue cue) { return cue < Cue::kRoll ? "m/s^2" : "deg/s"; }
double shown(PlatformAxis axis, double value) { return turns(axis) ? value / kDegree : 1000.0 * value; }
const char* shown_unit(PlatformAxis axis) { return turns(axis) ? "deg" : "mm"; }

bool is_moved(const CueingResult& result, Cue cue) {
  const FeltMotion& felt = result.algorithms.front().felt;
  const std::vector<double>& v = felt.felt[cue].vehicle;
  return std::any_of(v.begin(), v.end(), [&](double x) { return std::abs(x) > felt.threshold[cue]; });
}

IntervalPlot correlation_figure(const CueingResult& result) {
  IntervalPlot plot{
      .title = "Correlation of what is felt with what was felt in the vehicle",
      .caption =
          "1: as in the vehicle. 0: nothing to do with it. Below 0: rather the other way. With 95 % intervals over "
          "blocks of 10 s, where the drive has four blocks or more.",
      .shared_scale = true};
  for (const AlgorithmResult& a : result.algorithms) plot.methods.push_back(a.run.algorithm);
  for (const Cue cue : kAllCues) {
    if (!is_moved(result, cue)) continue;
    IntervalRow row{.name = std::string(name_of(cue))};
    for (const AlgorithmResult& a : result.algorithms) {
      const Measured& m = a.score.cues[cue].pearson;
      row.estimates.push_back({.value = m.value, .low = m.low, .high = m.high});
    }
    plot.rows.push_back(std::move(row));
  }
  return plot;
}

TimeSeries felt_histories(const CueingResult& result) {
  TimeSeries figure{.title = "Felt force and rate",
                    .caption = "Grey: in the vehicle. Coloured: on the platform, after canals and otoliths."};
  figure.samples = result.algorithms.front().felt.time;
  for (const Cue cue : kAllCues) {
    if (!is_moved(result, cue)) continue;
    const auto in_unit = [&](std::vector<double> values) {
      for (double& v : values) v = shown(cue, v);
      return values;
    };
    Panel panel{.label = std::string(name_of(cue)), .unit = shown_unit(cue)};
    panel.lines.push_back(
        {.name = "vehicle", .y = in_unit(result.algorithms.front().felt.felt[cue].vehicle), .role = Role::kMeasured});
    for (const AlgorithmResult& a : result.algorithms)
      panel.lines.push_back({.name = a.run.algorithm, .y = in_unit(a.felt.felt[cue].platform)});
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

TimeSeries platform_histories(const CueingStudy& study, const CueingResult& result) {
  TimeSeries figure{.title = "Position over time",
                    .caption = "Where it is after legs and actuators. Dashed: limits, where more than half is used."};
  figure.samples = result.algorithms.front().felt.time;
  for (const PlatformAxis which : study.platform.limits.moving_axes()) {
    const AxisLimits& limits = study.platform.limits[which];
    Panel panel{.label = std::string(name_of(which)), .unit = shown_unit(which)};
    double most = 0.0;
    for (const AlgorithmResult& a : result.algorithms) {
      Line line{.name = a.run.algorithm};
      for (const CueingStep& s : a.run.steps) line.y.push_back(shown(which, axis(s.reached, which).position));
      most = std::max(most, a.score.axes[which].used);
      panel.lines.push_back(std::move(line));
    }
    if (most > 0.5) {
      for (const auto& [name, limit] :
           {std::pair("upper limit", limits.highest), std::pair("lower limit", limits.lowest)})
        panel.lines.push_back({.name = name,
                               .y = std::vector<double>(figure.samples.size(), shown(which, limit)),
                               .role = Role::kReference});
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

TimeSeries knob_figure(const AlgorithmResult& a) {
  TimeSeries figure{
      .title = fmt::format("Knobs of {}", a.run.algorithm),
      .caption = "The cue that each changes most. Braking at 2 s, a bend to the left at 11 s, a bump at 22 s."};
  figure.samples = a.effects.front().time;
  for (const KnobEffect& e : a.effects) {
    if (e.difference <= 0.0) continue;
    const auto in_unit = [&](std::vector<double> values) {
      for (double& v : values) v = shown(e.cue, v);
      return values;
    };
    Panel panel{.label = fmt::format("{}: {}", e.knob.name, name_of(e.cue)), .unit = shown_unit(e.cue)};
    panel.lines.push_back({.name = "vehicle", .y = in_unit(e.vehicle), .role = Role::kMeasured});
    constexpr std::array kNamesOfFactors = {"half", "as set", "twice"};
    for (std::size_t f = 0; f < e.factors.size(); ++f) {
      if (f != 1 && e.factors[f] == 1.0) continue;
      panel.lines.push_back({.name = kNamesOfFactors[f], .y = in_unit(e.platform[f])});
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

}  // namespace veridyn::report
