#include "veridyn/report/figures/aircraft_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/reconstruction/information_bound.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/report/figures/curves.hpp"
#include "veridyn/report/figures/time_range.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::aircraft;

/// Of a figure of the first screen: height of a panel [CSS px], most windows of a figure that takes half of the width.
constexpr int kLeadHeight = 84;
constexpr std::size_t kLeadWindows = 3;
constexpr double kLeadWindow_s = 20.0;  // longer ones show no single oscillation

Line estimate_line(const Recording& recording, const std::string& channel, const char* label, double factor) {
  Line line{.name = label};
  const Channel* value = recording.find(channel);
  if (value == nullptr) return line;
  line.x.assign(value->times().begin(), value->times().end());
  line.y = scaled(value->value, factor);
  const Channel* sigma = recording.find("sigma_" + channel);
  if (sigma != nullptr && sigma->size() == value->size()) {
    Band band;
    for (std::size_t i = 0; i < line.y.size(); ++i) {
      const double half = numerics::kNormal95 * sigma->value[i] * factor;
      band.low.push_back(line.y[i] - half);
      band.high.push_back(line.y[i] + half);
    }
    line.band = std::move(band);
  }
  return line;
}

void add_channel(Panel& panel, const Recording& recording, const char* channel, const char* label, double factor,
                 Role role) {
  const Channel* found = recording.find(channel);
  if (found == nullptr) return;
  panel.lines.push_back({.name = label,
                         .y = scaled(found->value, factor),
                         .x = {found->times().begin(), found->times().end()},
                         .role = role});
}

/// @param shift_s  added to the times
std::vector<Span> segment_spans(const Segments& segments, bool longitudinal, bool lateral, double shift_s = 0.0) {
  std::vector<Span> spans;
  const auto add = [&](const AxisSegments& axis) {
    for (const TimeSpan& s : axis.identification) {
      spans.push_back({.from = s.begin + shift_s,
                       .to = s.end + shift_s,
                       .label = fmt::format("{} identification", to_string(axis.axis)),
                       .tone = SpanTone::kPrimary});
    }
    for (const TimeSpan& s : axis.holdout) {
      spans.push_back({.from = s.begin + shift_s,
                       .to = s.end + shift_s,
                       .label = fmt::format("{} hold-out", to_string(axis.axis)),
                       .tone = SpanTone::kSecondary});
    }
  };
  if (longitudinal) add(segments.longitudinal);
  if (lateral) add(segments.lateral);
  return spans;
}

/// Root mean square difference of a channel from the truth, on the truth's stamps inside the airborne spans.
double rms_error(const Recording& estimate, const Recording& truth, const char* channel) {
  const Channel* e = estimate.find(channel);
  const Channel* t = truth.find(channel);
  if (e == nullptr || t == nullptr) return kNaN;
  const auto times = e->times();
  double sum = 0.0;
  std::size_t count = 0;
  std::size_t j = 0;
  const auto true_times = t->times();
  for (std::size_t i = 0; i < times.size(); ++i) {
    while (j + 1 < true_times.size() && true_times[j + 1] <= times[i]) ++j;
    if (j + 1 >= true_times.size() || true_times[j] > times[i] || !std::isfinite(e->value[i])) continue;
    const double share = (times[i] - true_times[j]) / (true_times[j + 1] - true_times[j]);
    const double expected = (1.0 - share) * t->value[j] + share * t->value[j + 1];
    sum += (e->value[i] - expected) * (e->value[i] - expected);
    ++count;
  }
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : kNaN;
}

bool same_windows(const std::vector<Window>& a, const std::vector<Window>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Window& i, const Window& j) { return i.from == j.from && i.to == j.to; });
}

/// Measured, and the model where its values predict; with its verdict where they are no physical constants.
Panel coefficient_panel(const CoefficientResult& r) {
  Panel panel{.label = r.verdict == estimation::GroupVerdict::kIdentified
                           ? r.name
                           : fmt::format("{} ({})", r.name, to_string(r.verdict))};
  panel.lines.push_back({.name = "measured", .y = r.measured, .x = r.time, .role = Role::kMeasured});
  if (estimation::usable(r.verdict)) panel.lines.push_back({.name = "model", .y = r.modelled, .x = r.time});
  return panel;
}

/// Errors of the state estimates of a simulated flight alongside the best that the sensors allow.
Table bound_table(const FlightStudy& study, const PreparedFlight& flight) {
  Table table{.title = "Against the truth and the information bound",
              .caption =
                  "Root mean square errors. The bound is what no estimator that does not know the aircraft can "
                  "undercut, from the "
                  "gust spectrum and the vanes alone, with attitude and ground velocity taken as exact.",
              .columns = {{.name = "Quantity"},
                          {.name = "Filter", .digits = 3},
                          {.name = "Bound", .digits = 3},
                          {.name = "Smoother", .digits = 3},
                          {.name = "Bound", .digits = 3},
                          {.name = "Unit"}}};
  const Reconstruction& rec = flight.reconstruction;
  const Channel* airspeed = rec.smoothed.find("airspeed");
  if (airspeed == nullptr || airspeed->empty()) return table;
  double mean = 0.0;
  for (const double v : airspeed->value) mean += v / static_cast<double>(airspeed->size());
  const Channel* vane = flight.aligned.recording.find("alpha");
  const double rate = vane != nullptr ? vane->rate_Hz() : 0.0;
  InformationBound bound;
  if (rate > 0.0) bound = information_bound(rec.turbulence, mean, rec.sigma.alpha, rate);
  const auto row = [&](const char* name, double factor, const char* unit, const AngleBound* best) {
    const bool has = best != nullptr && rate > 0.0;
    table.rows.push_back({.cells = {text_cell(name), number_cell(factor * rms_error(rec.filtered, *study.truth, name)),
                                    number_cell(has ? factor * best->filter : kNaN),
                                    number_cell(factor * rms_error(rec.smoothed, *study.truth, name)),
                                    number_cell(has ? factor * best->smoother : kNaN), text_cell(unit)}});
  };
  row("alpha", 1.0 / kDegree, "deg", &bound.alpha);
  row("beta", 1.0 / kDegree, "deg", &bound.beta);
  row("airspeed", 1.0, "m/s", nullptr);
  return table;
}

}  // namespace

Section flight_section(const FlightStudy& study, const PreparedFlight& flight) {
  Section section{.title = "The flight", .id = "flight"};
  const Recording& smoothed = flight.reconstruction.smoothed;
  const Recording& measured = flight.aligned.recording;
  const bool filtered = flight.reconstruction.filter != FilterKind::kNone;
  const char* const estimator = filtered ? "smoother" : "low-passed";
  TimeSeries air{.title = "Motion through the air",
                 .caption = fmt::format("{} Shaded: what was used to identify (longitudinal and lateral) and what was "
                                        "held out.",
                                        filtered ? "Estimates of the smoother with 95 % bands."
                                                 : "As recorded, without a filter, with 95 % bands of their noise.")};
  air.spans = segment_spans(flight.segments, true, true);
  const auto panel = [&](const char* channel, const char* label, const char* unit, double factor, const char* sensor) {
    Panel p{.label = label, .unit = unit};
    add_channel(p, measured, sensor, "measured", factor, Role::kMeasured);
    if (smoothed.has(channel)) p.lines.push_back(estimate_line(smoothed, channel, estimator, factor));
    if (study.truth) add_channel(p, *study.truth, channel, "truth", factor, Role::kReference);
    if (!p.lines.empty()) air.panels.push_back(std::move(p));
  };
  panel("airspeed", "airspeed", "m/s", 1.0, "airspeed");
  panel("alpha", "alpha", "deg", 1.0 / kDegree, "alpha");
  panel("beta", "beta", "deg", 1.0 / kDegree, "beta");
  Panel wind{.label = "slow wind", .unit = "m/s"};
  for (const char* axis : {"north", "east", "down"})
    if (const std::string channel = std::string("wind_") + axis; smoothed.has(channel))
      wind.lines.push_back(estimate_line(smoothed, channel, axis, 1.0));
  if (!wind.lines.empty()) air.panels.push_back(std::move(wind));
  section.blocks.emplace_back(std::move(air));
  if (study.truth) section.blocks.emplace_back(bound_table(study, flight));

  TimeSeries inputs{.title = "Inputs and rates"};
  Panel surfaces{.label = "deflections", .unit = "deg"};
  for (const char* name : {"elevator", "aileron", "rudder"})
    add_channel(surfaces, measured, name, name, 1.0 / kDegree, Role::kEstimate);
  if (!surfaces.lines.empty()) inputs.panels.push_back(std::move(surfaces));
  Panel throttle{.label = "throttle", .unit = "%", .height = 100};
  add_channel(throttle, measured, "throttle", "throttle", 100.0, Role::kEstimate);
  if (!throttle.lines.empty()) inputs.panels.push_back(std::move(throttle));
  Panel rates{.label = "body rates", .unit = "deg/s"};
  for (const auto& [channel, name] : {std::pair{"gyro_x", "p"}, std::pair{"gyro_y", "q"}, std::pair{"gyro_z", "r"}}) {
    add_channel(rates, measured, channel, name, 1.0 / kDegree, Role::kEstimate);
  }
  inputs.panels.push_back(std::move(rates));
  Panel attitude{.label = "attitude", .unit = "deg"};
  for (const char* name : {"roll", "pitch"})
    add_channel(attitude, smoothed, name, name, 1.0 / kDegree, Role::kEstimate);
  if (!attitude.lines.empty()) inputs.panels.push_back(std::move(attitude));
  inputs.spans = segment_spans(flight.segments, true, true);
  section.blocks.emplace_back(std::move(inputs));
  return section;
}

std::optional<Window> flown_range(const PreparedFlight& flight) {
  const std::vector<TimeSpan>& flown = flight.segments.airborne;
  if (flown.empty()) return std::nullopt;
  const double margin = std::max(2.0, 0.03 * (flown.back().end - flown.front().begin));
  return Window{flown.front().begin - margin, flown.back().end + margin};
}

std::vector<TimeSeries> coefficient_lead(const FlightAnalysis& analysis, bool given) {
  std::vector<TimeSeries> figures;
  for (const Axis axis : {Axis::kLongitudinal, Axis::kLateral}) {
    std::vector<Window> unseen, identification;
    for (const PreparedFlight& flight : analysis.flights) {
      const auto append = [&](std::vector<Window>& windows, const std::vector<TimeSpan>& spans) {
        for (const TimeSpan& s : spans) windows.push_back({s.begin + flight.shift_s, s.end + flight.shift_s});
      };
      const AxisSegments& segments = flight.segments.of(axis);
      append(unseen, given ? segments.excited : segments.holdout);
      append(identification, segments.identification);
    }
    const bool held_out = !unseen.empty();
    TimeSeries figure{.title = fmt::format("{}{}", axis == Axis::kLongitudinal ? "Longitudinal" : "Lateral",
                                           given      ? ", given model"
                                           : held_out ? ", held-out data"
                                                      : ", nothing held out"),
                      .windows = held_out ? std::move(unseen) : std::move(identification)};
    for (const CoefficientResult& r : analysis.coefficients) {
      if (r.axis != axis || r.time.empty()) continue;
      figure.panels.push_back(coefficient_panel(r));
      figure.panels.back().height = kLeadHeight;
    }
    if (!figure.panels.empty() && !figure.windows.empty())
      figures.push_back(in_longest_windows(std::move(figure), kLeadWindows, kLeadWindow_s));
  }
  return figures;
}

Section coefficient_series_section(const FlightAnalysis& analysis) {
  Section section{.title = "Coefficients over time", .id = "series", .folded = true};
  for (const Axis axis : {Axis::kLongitudinal, Axis::kLateral}) {
    TimeSeries figure{.title = axis == Axis::kLongitudinal ? "Longitudinal coefficients" : "Lateral coefficients",
                      .caption =
                          "Measured: from specific force, rates and dynamic pressure. Model: the chosen estimate, "
                          "where it is not rejected."};
    for (const PreparedFlight& flight : analysis.flights) {
      const std::vector<Span> spans =
          segment_spans(flight.segments, axis == Axis::kLongitudinal, axis == Axis::kLateral, flight.shift_s);
      figure.spans.insert(figure.spans.end(), spans.begin(), spans.end());
    }
    for (const CoefficientResult& r : analysis.coefficients) {
      if (r.axis != axis || r.time.empty()) continue;
      figure.panels.push_back(coefficient_panel(r));
    }
    if (!figure.panels.empty()) section.blocks.emplace_back(std::move(figure));
  }
  return section;
}

std::vector<TimeSeries> validation_figures(const Validation& validation) {
  std::vector<TimeSeries> figures;
  if (!validation.available()) return figures;
  for (const PredictedQuantity& q : validation.quantities) {
    const std::vector<Window> windows = windows_of(q.time);
    // Longitudinal and lateral quantities are held out at different times.
    const bool other = figures.empty() || !same_windows(figures.back().windows, windows);
    if (other) {
      figures.push_back(
          {.title = "Flown by the model on held-out data",
           .caption = fmt::format("Started again every {:.1f} s from the reconstructed state.", validation.period_s),
           .windows = windows});
    }
    const double factor = q.unit == "deg" ? 1.0 / kDegree : 1.0;
    Panel panel{.label = q.name, .unit = q.unit};
    panel.lines.push_back({.name = "measured", .y = scaled(q.measured, factor), .x = q.time, .role = Role::kMeasured});
    panel.lines.push_back({.name = "model", .y = scaled(q.predicted, factor), .x = q.time});
    figures.back().panels.push_back(std::move(panel));
  }
  return figures;
}

XYPlot residual_autocorrelation_plot(const CoefficientResult& result) {
  XYPlot plot{.title = fmt::format("{}: residual autocorrelation", result.name),
              .caption = "Inside the dashed lines 95 % of the time when the residual is white.",
              .x = {.label = "lag", .unit = "s"},
              .y = {.label = "correlation"}};
  XYSeries series{.name = "residual", .style = Style::kStems};
  for (std::size_t i = 0; i < result.residual_autocorrelation.value.size(); ++i) {
    series.x.push_back(static_cast<double>(i) * result.row_interval_s);
    series.y.push_back(result.residual_autocorrelation.value[i]);
  }
  plot.series.push_back(std::move(series));
  const double bound = result.residual_autocorrelation.white_bound95;
  plot.guides = {{.value = bound, .label = "95 % if white"}, {.value = -bound}};
  return plot;
}

XYPlot residual_normal_plot(const CoefficientResult& result) {
  const numerics::NormalPlot& normal = result.chosen->normal_plot;
  XYPlot plot{.title = fmt::format("{}: normal probability plot", result.name),
              .caption = "On the line when the residual is normally distributed.",
              .x = {.label = "normal quantile"},
              .y = {.label = "residual"}};
  plot.series.push_back({.name = "residual", .x = normal.quantile, .y = normal.sample});
  plot.series.push_back({.name = "normal",
                         .x = {-4.0, 4.0},
                         .y = {normal.mean - 4.0 * normal.sd, normal.mean + 4.0 * normal.sd},
                         .role = Role::kReference,
                         .style = Style::kLine});
  return plot;
}

}  // namespace veridyn::report
