#include "veridyn/report/drive_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/deg_per_g.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/report/document/number_format.hpp"
#include "veridyn/report/figures/curves.hpp"
#include "veridyn/report/figures/time_range.hpp"
#include "veridyn/report/parts/analysis_sections.hpp"
#include "veridyn/report/parts/drive_path_section.hpp"
#include "veridyn/report/parts/open_loop_section.hpp"
#include "veridyn/report/parts/profile_section.hpp"
#include "veridyn/report/parts/remarks.hpp"
#include "veridyn/report/parts/tried_structures_section.hpp"
#include "veridyn/report/vehicle_report.hpp"
#include "veridyn/vehicle/identification/fit/vehicle_profiles.hpp"
#include "veridyn/vehicle/model/bicycle_analysis.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::vehicle;

Verdict verdict(const VehicleAnalysis& a) {
  Verdict v = verdict_of(a.estimate);
  // Why it is less is in the lines of the rows.
  if (a.identification.verdict == estimation::GroupVerdict::kIdentified)
    v.lines.insert(v.lines.begin(), a.identification.reason);
  return v;
}

std::vector<Fact> facts(const VehicleStudy& study, const VehicleAnalysis& a) {
  const VehicleParameters<double>& p = study.vehicle;
  std::vector<Fact> list{{"Vehicle", study.subject_name},
                         {"Mass, a, b", fmt::format("{:g} kg, {:g} m, {:g} m", p.mass, p.a, p.b)},
                         {"Log", study.log.mapped.recording.source},
                         {"Grid", fmt::format("{:g} Hz, {:.1f} s", 1.0 / a.signals.grid.step,
                                              a.signals.grid.step * static_cast<double>(a.signals.size()))},
                         {"Identified on", fmt::format("{:.1f} s", recording::total_s(a.segments.identification))},
                         {"Held out", fmt::format("{:.1f} s", recording::total_s(a.segments.holdout))}};
  if (const VehicleEstimate* best = a.identification.best())
    list.push_back({"Method", std::string(to_string(best->method))});
  if (!a.estimate.structure.empty()) list.push_back({"Structure", a.estimate.structure});
  return list;
}

/// A quantity of all stretches of a prediction, one after the other, with a break between stretches.
struct Stretches {
  std::vector<double> time, measured, predicted, low, high;

  void add(const std::vector<double>& stamps, const std::vector<double>& seen, const std::vector<double>& model,
           const std::vector<double>& sigma, double factor) {
    if (stamps.empty()) return;
    const auto at = [](const std::vector<double>& values, std::size_t k) {
      return k < values.size() ? values[k] : kNaN;
    };
    for (std::size_t k = 0; k < stamps.size(); ++k) {
      const double half = numerics::kNormal95 * at(sigma, k);
      append(stamps[k], factor * at(seen, k), factor * at(model, k), factor * (at(model, k) - half),
             factor * (at(model, k) + half));
    }
    append(stamps.back() + 1e-6, kNaN, kNaN, kNaN, kNaN);
  }

  /// Without the lines that have no number.
  [[nodiscard]] std::vector<Line> lines() const {
    std::vector<Line> result;
    if (any_finite(measured)) result.push_back({.name = "measured", .y = measured, .role = Role::kMeasured});
    if (!any_finite(predicted)) return result;
    result.push_back({.name = "predicted", .y = predicted});
    if (any_finite(low)) result.back().band = Band{low, high};
    return result;
  }

 private:
  void append(double t, double seen, double model, double from, double to) {
    time.push_back(t);
    measured.push_back(seen);
    predicted.push_back(model);
    low.push_back(from);
    high.push_back(to);
  }
};

/// Most stretches of a drive on the first screen.
constexpr std::size_t kLeadStretches = 6;

/// The drives of a prediction side by side, each with its own time.
TimeSeries prediction_figure(const DriveValidation& v, const std::string& title) {
  TimeSeries figure{.title = title,
                    .caption =
                        "Simulated from measured steering and speed, with lateral velocity and yaw rate fitted "
                        "where each stretch begins. Bands are 95 %, from the parameters alone."};
  const std::vector<double> none;
  Stretches steer, yaw_rate, acceleration, lateral;
  for (const PredictedStretch& d : v.stretches) {
    steer.add(d.time, d.steer, none, none, 1.0 / kDegree);
    yaw_rate.add(d.time, d.yaw_rate, d.yaw_rate_predicted, d.yaw_rate_sigma, 1.0 / kDegree);
    acceleration.add(d.time, d.accel_y, d.accel_y_predicted, d.accel_y_sigma, 1.0);
    lateral.add(d.time, d.lateral_velocity, d.lateral_velocity_predicted, none, 1.0);
    if (d.time.size() > 1) figure.windows.push_back({.from = d.time.front(), .to = d.time.back()});
  }
  figure.samples = steer.time;
  const auto add = [&](const char* label, const char* unit, const Stretches& stretches, int height) {
    Panel panel{.label = label, .unit = unit, .lines = stretches.lines(), .height = height};
    if (!panel.lines.empty()) figure.panels.push_back(std::move(panel));
  };
  add("yaw rate", "deg/s", yaw_rate, 110);
  add("lateral acceleration", "m/s^2", acceleration, 110);
  add("lateral velocity", "m/s", lateral, 110);
  add("steer angle", "deg", steer, 60);
  return figure;
}

XYPlot path_plot(const DriveValidation& v) {
  XYPlot plot{.title = "Paths of the held-out stretches",
              .caption = "Each from its own beginning, heading along x there.",
              .x = {"x", "m"},
              .y = {"y", "m"},
              .equal_scale = true,
              .height = 380};
  for (const PredictedStretch& d : v.stretches) {
    if (!d.x.empty())
      plot.series.push_back({.name = "measured", .x = d.x, .y = d.y, .role = Role::kMeasured, .style = Style::kLine});
    if (!d.x_predicted.empty())
      plot.series.push_back({.name = "predicted", .x = d.x_predicted, .y = d.y_predicted, .style = Style::kLine});
  }
  return plot;
}

/// Signals of the usable stretches, thinned.
struct Cornering {
  std::vector<double> lateral, longitudinal, extra_steer;
};
Cornering cornering(const VehicleAnalysis& a, const VehicleParameters<double>& p) {
  Cornering c;
  const auto& s = a.signals;
  const bool has_ax = s[DriveSignal::kAccelX].available(), has_ay = s[DriveSignal::kAccelY].available();
  const bool has_steer = s[DriveSignal::kSteer].available();
  const std::size_t stride = std::max<std::size_t>(1, s.size() / 4000);
  for (const TimeSpan& span : a.segments.usable) {
    const auto [begin, end] = s.indices(span);
    for (std::size_t k = begin; k < end; k += stride) {
      const double u = s[DriveSignal::kSpeed].value[k], r = s[DriveSignal::kYawRate].value[k];
      const double a_y = has_ay ? s[DriveSignal::kAccelY].value[k] : u * r;
      c.lateral.push_back(a_y / kGravity);
      c.longitudinal.push_back(has_ax ? s[DriveSignal::kAccelX].value[k] / kGravity : kNaN);
      c.extra_steer.push_back(has_steer ? (s[DriveSignal::kSteer].value[k] - p.wheelbase() * r / u) / kDegree : kNaN);
    }
  }
  return c;
}

Section cornering_section(const VehicleAnalysis& a, const VehicleParameters<double>& p) {
  const Cornering c = cornering(a, p);
  Section section{.title = "How it was driven", .folded = true};
  section.blocks.emplace_back(XYPlot{.title = "Understeer diagram",
                                     .caption = "Steer beyond the Ackermann angle L r/u over lateral acceleration: in "
                                                "steady cornering its slope is the understeer gradient (ISO 4138).",
                                     .x = {"lateral acceleration", "g"},
                                     .y = {"steer - L r/u", "deg"},
                                     .series = {{.name = "measured",
                                                 .x = c.lateral,
                                                 .y = c.extra_steer,
                                                 .role = Role::kMeasured,
                                                 .width = 2.0,
                                                 .opacity = 0.4},
                                                [&] {
                                                  XYSeries line{
                                                      .name = "identified", .style = Style::kLine, .width = 2.0};
                                                  const double K = deg_per_g(understeer_gradient(p));
                                                  double most = 0.0;
                                                  for (const double x : c.lateral)
                                                    if (std::abs(x) > most) most = std::abs(x);
                                                  line.x = {-most, most};
                                                  line.y = {-K * most, K * most};
                                                  return line;
                                                }()},
                                     .height = 320});
  if (any_finite(c.longitudinal)) {
    section.blocks.emplace_back(XYPlot{.title = "g-g diagram",
                                       .x = {"lateral acceleration", "g"},
                                       .y = {"longitudinal acceleration", "g"},
                                       .series = {{.name = "measured",
                                                   .x = c.lateral,
                                                   .y = c.longitudinal,
                                                   .role = Role::kMeasured,
                                                   .width = 2.0,
                                                   .opacity = 0.4}},
                                       .equal_scale = true,
                                       .height = 320});
  }
  return section;
}

TimeSeries signal_figure(const VehicleAnalysis& a) {
  TimeSeries figure{.title = "Signals and stretches", .caption = a.segments.text};
  const std::size_t n = a.signals.size();
  for (std::size_t k = 0; k < n; ++k)
    figure.samples.push_back(a.signals.grid.begin + a.signals.grid.step * static_cast<double>(k));
  for (const auto& [signal, label, unit, factor] :
       {std::tuple{DriveSignal::kSteer, "steer angle", "deg", 1.0 / kDegree},
        std::tuple{DriveSignal::kSpeed, "speed", "m/s", 1.0},
        std::tuple{DriveSignal::kYawRate, "yaw rate", "deg/s", 1.0 / kDegree},
        std::tuple{DriveSignal::kAccelY, "lateral acceleration", "m/s^2", 1.0}}) {
    if (!a.signals[signal].available()) continue;
    figure.panels.push_back(
        {.label = label,
         .unit = unit,
         .lines = {{.name = "measured", .y = scaled(a.signals[signal].value, factor), .role = Role::kMeasured}},
         .height = 100});
  }
  if (!a.segments.usable.empty()) {
    const double begin = a.segments.usable.front().begin, end = a.segments.usable.back().end;
    const double margin = std::max(2.0, 0.03 * (end - begin));
    const Window driven{begin - margin, end + margin};
    keep_within(figure, std::span(&driven, 1));
  }
  for (const TimeSpan& s : a.segments.identification)
    figure.spans.push_back({.from = s.begin, .to = s.end, .label = "identification", .tone = SpanTone::kPrimary});
  for (const TimeSpan& s : a.segments.holdout)
    figure.spans.push_back({.from = s.begin, .to = s.end, .label = "hold-out", .tone = SpanTone::kSecondary});
  return figure;
}

Table origin_table(const VehicleStudy& study) {
  Table table{.title = "Where the signals come from",
              .columns = {{.name = "channel", .align = Align::kLeft},
                          {.name = "source", .align = Align::kLeft},
                          {.name = "rate", .unit = "Hz"},
                          {.name = "note", .align = Align::kLeft}}};
  for (const recording::ChannelOrigin& o : study.log.mapped.origins) {
    table.rows.push_back(
        {.cells = {text_cell(o.channel), text_cell(o.source), number_cell(o.rate_Hz), text_cell(o.note)}});
  }
  return table;
}

Section validation_section(const DriveValidation& validation) {
  Section section{.title = "Validation on held-out data"};
  section.blocks.emplace_back(prediction_table(validation.quantities, "Prediction of the hold-out"));
  // Fewer are all on the first screen.
  if (TimeSeries all = prediction_figure(validation, "All stretches that were held out");
      all.windows.size() > kLeadStretches)
    section.blocks.emplace_back(std::move(all));
  XYPlot path = path_plot(validation);
  if (!path.series.empty()) section.blocks.emplace_back(std::move(path));
  return section;
}

Section fit_section(const DriveValidation& fit) {
  Section section{.title = "Fit", .folded = true};
  section.blocks.emplace_back(prediction_table(fit.quantities, "On the data of the identification"));
  section.blocks.emplace_back(prediction_figure(fit, "Measured and predicted, identification"));
  return section;
}

Section response_section(const VehicleParameters<double>& p, double speed) {
  Section section{.title = "Frequency response", .folded = true};
  section.blocks.emplace_back(
      Paragraph{fmt::format("Of the identified linear bicycle at the drive's mean speed of {:.3g} m/s.", speed)});
  const std::vector<NamedBicycle> bicycles{
      {"identified", LinearBicycle<double>{p.mass, p.I_z, p.a, p.b, p.C_f, p.C_r, speed}}};
  for (Block& block : frequency_response_figures(bicycles)) section.blocks.push_back(std::move(block));
  return section;
}

Section data_section(const VehicleStudy& study, const VehicleAnalysis& analysis) {
  Section section{.title = "Data", .folded = true};
  section.blocks.emplace_back(signal_figure(analysis));
  section.blocks.emplace_back(origin_table(study));
  for (const auto& notes : {study.notes, study.log.mapped.notes, analysis.signals.notes})
    if (!notes.empty()) section.blocks.emplace_back(List{notes, Tone::kNote});
  return section;
}

}  // namespace

std::optional<double> response_speed(std::span<const double> speed) {
  for (const double least : {3.0, 0.1}) {
    double sum = 0.0;
    std::size_t count = 0;
    for (const double u : speed) {
      if (std::isfinite(u) && u > least) sum += u, ++count;
    }
    if (count > 0) return sum / static_cast<double>(count);
  }
  return std::nullopt;
}

Document drive_report(const VehicleStudy& study, const VehicleAnalysis& analysis, const DriveReportContext& context) {
  const VehicleIdentification& id = analysis.identification;
  Document document = started_document(
      study.name, context.validation_only ? "An estimate validated on a held-out drive" : study.subject_name,
      context.program);
  document.verdict = verdict(analysis);
  const bool held_out = !id.validation.stretches.empty();
  TimeSeries lead = held_out
                        ? prediction_figure(id.validation, "Measured and model on held-out data")
                        : prediction_figure(id.fit, "Nothing was held out: measured and model where it was fitted");
  if (!lead.windows.empty()) document.lead.emplace_back(in_longest_windows(std::move(lead), kLeadStretches));
  document.facts = facts(study, analysis);
  const auto add = [&](Section section) {
    if (!section.blocks.empty()) document.sections.push_back(std::move(section));
  };
  add(parameters_section(
      analysis,
      "Stiffnesses are of one tyre. Motion alone shows ratios to the mass; its error is in the error "
      "bars where [identify.uncertainty] gives it."));
  add(tried_structures_section(analysis.estimate));
  add(profile_section(id.profiles, profiled_parameters(id),
                      "Autocorrelated residuals and parts of the drive that scatter widen profiles as they widen the "
                      "error bars; what [identify.uncertainty] adds is in the error bars only."));
  if (held_out) add(validation_section(id.validation));
  add(open_loop_section(analysis.open_loop));
  add(drive_path_section(analysis.open_loop.path));
  add(methods_section(analysis));
  add(evidence_section(analysis.estimate));
  if (!id.fit.stretches.empty()) document.sections.push_back(fit_section(id.fit));
  const VehicleParameters<double>& p = id.best() != nullptr ? id.identified : study.vehicle;
  document.sections.push_back(cornering_section(analysis, p));
  const std::optional<double> speed = response_speed(analysis.signals[DriveSignal::kSpeed].value);
  if (id.best() != nullptr && speed) document.sections.push_back(response_section(p, *speed));
  document.sections.push_back(data_section(study, analysis));
  add(rejected_section(analysis));
  add_warnings(document, id.warnings);
  return document;
}

}  // namespace veridyn::report
