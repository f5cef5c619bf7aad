#include "veridyn/report/drive_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "veridyn/report/vehicle_report.hpp"
#include "veridyn/vehicle/model/bicycle_analysis.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::vehicle;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kStandardGravity = 9.80665;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double truth_of(const DriveReportContext& context, const std::string& name) {
  for (const auto& [key, value] : context.truth)
    if (key == name) return value;
  return kNaN;
}

std::vector<double> times(const std::vector<double>& values, double factor) {
  std::vector<double> out(values);
  for (double& v : out) v *= factor;
  return out;
}

Verdict verdict(const VehicleAnalysis& a) {
  Verdict v;
  const VehicleIdentification& id = a.identification;
  switch (id.verdict) {
    case VehicleVerdict::kIdentified:
      v.level = id.warnings.empty() ? Level::kGood : Level::kCaution;
      break;
    case VehicleVerdict::kNotExcited:
      v.level = Level::kCaution;
      v.word = "Not excited";
      break;
    case VehicleVerdict::kRejected:
      v.level = Level::kBad;
      break;
  }
  v.headline = id.reason;
  if (!id.validation.text.empty()) v.lines.push_back(id.validation.text);
  if (!id.warnings.empty()) v.lines.push_back(id.warnings.front());
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
  return list;
}

Table parameter_table(const VehicleEstimate& estimate, const DriveReportContext& context) {
  Table table{.title = fmt::format("Parameters by {}", to_string(estimate.method)),
              .caption =
                  "Stiffnesses are of one tyre. Motion alone shows ratios to the mass; its error is in the error "
                  "bars where [identify.uncertainty] gives it.",
              .columns = {{.name = "parameter", .align = Align::kLeft},
                          {.name = "value"},
                          {.name = "sigma", .digits = 2},
                          {.name = "95 % from"},
                          {.name = "to"},
                          {.name = "unit", .align = Align::kLeft},
                          {.name = "status"}}};
  if (!context.truth.empty()) table.columns.push_back({.name = "truth"});
  for (const estimation::ParameterEstimate& p : estimate.parameters) {
    const ReadableNumber value = readable(p.value, p.unit);
    const double factor = p.value != 0.0 ? value.value / p.value : readable(1.0, p.unit).value;
    const double sigma = p.sigma * factor;
    const Status status = status_from_name(estimation::to_string(p.status));
    Row row{.cells = {text_cell(p.name), measured_cell(value.value, sigma), number_cell(sigma),
                      measured_cell(p.low95 * factor, sigma), measured_cell(p.high95 * factor, sigma),
                      text_cell(value.unit), status_cell(status)},
            .status = status};
    if (!context.truth.empty()) row.cells.push_back(number_cell(truth_of(context, p.name) * factor));
    table.rows.push_back(std::move(row));
  }
  return table;
}

IntervalPlot interval_plot(const VehicleIdentification& id, const DriveReportContext& context) {
  IntervalPlot plot{.title = "Estimates of all methods",
                    .caption =
                        "Bars are 95 % intervals. Methods that disagree by more than their bars contradict each "
                        "other.",
                    .reference_name = "truth"};
  for (const VehicleEstimate& e : id.estimates)
    if (e.usable) plot.methods.emplace_back(to_string(e.method));
  for (const char* name : {"C_f", "C_r", "I_z", "understeer_gradient"}) {
    IntervalRow row{.name = name};
    double factor = 1.0;
    for (const VehicleEstimate& e : id.estimates) {
      if (!e.usable) continue;
      const estimation::ParameterEstimate* p = e.find(name);
      if (p == nullptr) {
        row.estimates.push_back({kNaN, kNaN, kNaN});
        continue;
      }
      factor = readable(1.0, p->unit).value;
      row.unit = readable(1.0, p->unit).unit;
      row.estimates.push_back({p->value * factor, p->low95 * factor, p->high95 * factor,
                               status_from_name(estimation::to_string(p->status))});
    }
    const double truth = truth_of(context, name);
    if (std::isfinite(truth)) row.reference = truth * factor;
    if (!row.estimates.empty()) plot.rows.push_back(std::move(row));
  }
  return plot;
}

Table check_table(const VehicleIdentification& id) {
  Table table{
      .title = "Checks",
      .columns = {
          {.name = "check", .align = Align::kLeft}, {.name = ""}, {.name = "what was seen", .align = Align::kLeft}}};
  for (const estimation::HonestyCheck& c : id.checks) {
    table.rows.push_back(
        {.cells = {text_cell(c.name), status_cell(c.passed ? Status::kGood : Status::kBad), text_cell(c.text)}});
  }
  return table;
}

Table fit_table(const DriveValidation& v, const std::string& title) {
  Table table{.title = title,
              .columns = {{.name = "quantity", .align = Align::kLeft},
                          {.name = "MAE"},
                          {.name = "RMSE"},
                          {.name = "unit", .align = Align::kLeft},
                          {.name = "R2"},
                          {.name = "Theil"},
                          {.name = "residual lag 1"}}};
  for (const PredictedDriveQuantity& q : v.quantities) {
    const ReadableNumber unit = readable(1.0, q.unit);
    table.rows.push_back(
        {.cells = {text_cell(q.name), number_cell(q.fit.mae * unit.value), number_cell(q.fit.rmse * unit.value),
                   text_cell(unit.unit), number_cell(q.fit.r2), number_cell(q.fit.theil), number_cell(q.lag1, 2)}});
  }
  return table;
}

/// The drives of a prediction one after the other on the log's clock, parted by gaps.
TimeSeries prediction_figure(const DriveValidation& v, const std::string& title) {
  TimeSeries figure{.title = title,
                    .caption =
                        "Simulated from measured steering and speed; only the lateral velocity and yaw rate at the "
                        "beginning of each stretch were fitted. Bands are 95 %, from the parameters alone."};
  std::vector<double> steer, r, r_hat, r_low, r_high, a, a_hat, a_low, a_high, lateral, lateral_hat;
  const auto add = [](std::vector<double>& to, const std::vector<double>& from, std::size_t n, double factor) {
    for (std::size_t k = 0; k < n; ++k) to.push_back(k < from.size() ? factor * from[k] : kNaN);
  };
  const auto add_band = [](std::vector<double>& low, std::vector<double>& high, const std::vector<double>& middle,
                           const std::vector<double>& sigma, std::size_t n, double factor) {
    for (std::size_t k = 0; k < n; ++k) {
      const bool known = k < middle.size() && k < sigma.size();
      low.push_back(known ? factor * (middle[k] - 1.96 * sigma[k]) : kNaN);
      high.push_back(known ? factor * (middle[k] + 1.96 * sigma[k]) : kNaN);
    }
  };
  for (const PredictedStretch& d : v.stretches) {
    if (d.time.empty()) continue;
    const std::size_t n = d.time.size();
    figure.samples.insert(figure.samples.end(), d.time.begin(), d.time.end());
    add(steer, d.steer, n, 1.0 / kDegree);
    add(r, d.yaw_rate, n, 1.0 / kDegree);
    add(r_hat, d.yaw_rate_predicted, n, 1.0 / kDegree);
    add_band(r_low, r_high, d.yaw_rate_predicted, d.yaw_rate_sigma, n, 1.0 / kDegree);
    add(a, d.accel_y, n, 1.0);
    add(a_hat, d.accel_y_predicted, n, 1.0);
    add_band(a_low, a_high, d.accel_y_predicted, d.accel_y_sigma, n, 1.0);
    add(lateral, d.lateral_velocity, n, 1.0);
    add(lateral_hat, d.lateral_velocity_predicted, n, 1.0);
    // A break in the lines between stretches.
    figure.samples.push_back(d.time.back() + 1e-6);
    for (std::vector<double>* values :
         {&steer, &r, &r_hat, &r_low, &r_high, &a, &a_hat, &a_low, &a_high, &lateral, &lateral_hat})
      values->push_back(kNaN);
  }
  figure.panels.push_back({.label = "steer angle",
                           .unit = "deg",
                           .lines = {{.name = "measured", .y = steer, .role = Role::kMeasured}},
                           .height = 90});
  figure.panels.push_back({.label = "yaw rate",
                           .unit = "deg/s",
                           .lines = {{.name = "measured", .y = r, .role = Role::kMeasured},
                                     {.name = "predicted", .y = r_hat, .band = Band{r_low, r_high}}}});
  const auto known = [](double value) { return std::isfinite(value); };
  if (std::any_of(a.begin(), a.end(), known) || std::any_of(a_hat.begin(), a_hat.end(), known)) {
    figure.panels.push_back({.label = "lateral acceleration",
                             .unit = "m/s^2",
                             .lines = {{.name = "measured", .y = a, .role = Role::kMeasured},
                                       {.name = "predicted", .y = a_hat, .band = Band{a_low, a_high}}}});
  }
  Panel v_panel{.label = "lateral velocity", .unit = "m/s"};
  if (std::any_of(lateral.begin(), lateral.end(), known))
    v_panel.lines.push_back({.name = "measured", .y = lateral, .role = Role::kMeasured});
  if (std::any_of(lateral_hat.begin(), lateral_hat.end(), known))
    v_panel.lines.push_back({.name = "predicted", .y = lateral_hat});
  if (!v_panel.lines.empty()) figure.panels.push_back(std::move(v_panel));
  return figure;
}

XYPlot path_plot(const DriveValidation& v) {
  XYPlot plot{.title = "Paths of the stretches not seen",
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
      c.lateral.push_back(a_y / kStandardGravity);
      c.longitudinal.push_back(has_ax ? s[DriveSignal::kAccelX].value[k] / kStandardGravity : kNaN);
      c.extra_steer.push_back(has_steer ? (s[DriveSignal::kSteer].value[k] - p.wheelbase() * r / u) / kDegree : kNaN);
    }
  }
  return c;
}

Section cornering_section(const VehicleAnalysis& a, const VehicleParameters<double>& p) {
  const Cornering c = cornering(a, p);
  Section section{.title = "How it was driven"};
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
                                                  const double K = understeer_gradient(p) * kStandardGravity / kDegree;
                                                  double most = 0.0;
                                                  for (const double x : c.lateral)
                                                    if (std::abs(x) > most) most = std::abs(x);
                                                  line.x = {-most, most};
                                                  line.y = {-K * most, K * most};
                                                  return line;
                                                }()},
                                     .height = 320});
  const bool has_ax =
      std::any_of(c.longitudinal.begin(), c.longitudinal.end(), [](double v) { return std::isfinite(v); });
  if (has_ax) {
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
         .lines = {{.name = "measured", .y = times(a.signals[signal].value, factor), .role = Role::kMeasured}},
         .height = 100});
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

}  // namespace

Document drive_report(const VehicleStudy& study, const VehicleAnalysis& analysis, const DriveReportContext& context) {
  const VehicleIdentification& id = analysis.identification;
  Document document;
  document.title = study.name;
  document.subtitle =
      context.validation_only ? "An estimate tried on a drive that it has not seen" : study.subject_name;
  document.verdict = verdict(analysis);
  document.facts = facts(study, analysis);
  document.generator = "Made with " + context.program;

  Section parameters{.title = "Parameters"};
  if (const VehicleEstimate* best = id.best()) parameters.blocks.emplace_back(parameter_table(*best, context));
  IntervalPlot plot = interval_plot(id, context);
  if (plot.methods.size() > 1) parameters.blocks.emplace_back(std::move(plot));
  for (const VehicleEstimate& e : id.estimates) {
    if (!e.usable)
      parameters.blocks.emplace_back(Paragraph{fmt::format("{}: {}", to_string(e.method), e.message), Tone::kNote});
  }
  if (!id.checks.empty()) parameters.blocks.emplace_back(check_table(id));
  document.sections.push_back(std::move(parameters));

  if (!id.validation.stretches.empty()) {
    Section validation{.title = "Validation on data not seen"};
    validation.blocks.emplace_back(fit_table(id.validation, "Prediction of the hold-out"));
    validation.blocks.emplace_back(prediction_figure(id.validation, "Measured and predicted, hold-out"));
    XYPlot path = path_plot(id.validation);
    if (!path.series.empty()) validation.blocks.emplace_back(std::move(path));
    document.sections.push_back(std::move(validation));
  }
  if (!id.fit.stretches.empty()) {
    Section fit{.title = "Fit", .folded = true};
    fit.blocks.emplace_back(fit_table(id.fit, "On the data of the identification"));
    fit.blocks.emplace_back(prediction_figure(id.fit, "Measured and predicted, identification"));
    document.sections.push_back(std::move(fit));
  }
  const VehicleParameters<double>& p = id.best() != nullptr ? id.identified : study.vehicle;
  document.sections.push_back(cornering_section(analysis, p));
  if (id.best() != nullptr) {
    double speed = 0.0;
    std::size_t n = 0;
    for (const double u : analysis.signals[DriveSignal::kSpeed].value) {
      if (std::isfinite(u) && u > 3.0) speed += u, ++n;
    }
    speed = n > 0 ? speed / static_cast<double>(n) : 20.0;
    Section response{.title = "Frequency response"};
    response.blocks.emplace_back(
        Paragraph{fmt::format("Of the identified linear bicycle at the drive's mean speed of {:.3g} m/s.", speed)});
    const std::vector<NamedBicycle> bicycles{
        {"identified", LinearBicycle<double>{p.mass, p.I_z, p.a, p.b, p.C_f, p.C_r, speed}}};
    for (Block& block : frequency_response_figures(bicycles)) response.blocks.push_back(std::move(block));
    document.sections.push_back(std::move(response));
  }
  Section data{.title = "Data"};
  data.blocks.emplace_back(signal_figure(analysis));
  data.blocks.emplace_back(origin_table(study));
  for (const auto& notes : {study.notes, study.log.mapped.notes, analysis.signals.notes})
    if (!notes.empty()) data.blocks.emplace_back(List{notes, Tone::kNote});
  document.sections.push_back(std::move(data));
  if (!id.warnings.empty())
    document.sections.push_back({.title = "Warnings", .blocks = {List{id.warnings, Tone::kWarning}}});
  return document;
}

Document drive_tracking_report(const VehicleStudy& study, const TrackedDrive& drive,
                               const DriveReportContext& context) {
  Document document;
  document.title = study.name;
  document.subtitle = "Cornering stiffness followed on line";
  document.generator = "Made with " + context.program;
  const estimation::Estimate estimate = drive.estimate();
  document.facts = {{"Vehicle", study.subject_name}, {"Log", study.log.mapped.recording.source}};
  const DriveTracker* tracker = drive.tracker();
  document.verdict.headline = estimate.verdict;
  if (tracker == nullptr) {
    document.verdict.level = Level::kBad;
    return document;
  }
  const auto& changes = tracker->changes();
  document.verdict.level = changes.empty() ? Level::kGood : Level::kCaution;
  document.verdict.word = changes.empty() ? "No change" : "Changed";
  document.facts.push_back({"Rows", fmt::format("{} at {:g} Hz", tracker->rows(), tracker->row_rate_Hz())});
  document.facts.push_back({"Latency", fmt::format("{:.2f} s", tracker->latency_s())});

  Table table{.title = "Changes found",
              .columns = {{.name = "what", .align = Align::kLeft},
                          {.name = "detected", .unit = "s"},
                          {.name = "began", .unit = "s"},
                          {.name = "how", .align = Align::kLeft}}};
  for (const DriveChange& c : changes) {
    const bool mean = c.change.kind == estimation::ChangeKind::kMean;
    table.rows.push_back({.cells = {text_cell(std::string(kTrackedAxleNames[static_cast<std::size_t>(c.axle)])),
                                    number_cell(c.change.detected_s, 1), number_cell(c.change.began_s, 1),
                                    text_cell(mean ? fmt::format("innovation moved by {:.1f} sigma", c.change.shift)
                                                   : fmt::format("innovation grew {:.1f} times", c.change.shift))}});
  }
  Section found{.title = "Changes"};
  if (changes.empty()) {
    found.blocks.emplace_back(Paragraph{"None."});
  } else {
    found.blocks.emplace_back(std::move(table));
  }
  document.sections.push_back(std::move(found));

  Section section{.title = "Over time"};
  for (std::size_t i = 0; i < kTrackedAxles; ++i) {
    const DriveTrackHistory& h = tracker->history(static_cast<TrackedAxle>(i));
    if (h.time.empty()) continue;
    const ReadableNumber unit = readable(1.0, std::string(kTrackedAxleUnits[i]));
    TimeSeries figure{.title = fmt::format("{} over time", kTrackedAxleNames[i]),
                      .caption = "Bands are 95 %. Grey: not excited, the last value is held.",
                      .samples = h.time};
    Line line{.name = "on line", .y = times(h.value, unit.value)};
    // Wild values before there are data would hide everything else.
    const double limit = 4.0 * std::max(std::abs(line.y.back()), 1e-12);
    Band band;
    for (std::size_t k = 0; k < h.time.size(); ++k) {
      const double sigma = h.sigma[k] * unit.value;
      const bool shown = std::isfinite(sigma) && std::abs(line.y[k]) <= limit;
      if (!shown) line.y[k] = kNaN;
      band.low.push_back(shown ? std::max(-limit, line.y[k] - 1.96 * sigma) : kNaN);
      band.high.push_back(shown ? std::min(limit, line.y[k] + 1.96 * sigma) : kNaN);
    }
    line.band = std::move(band);
    Panel value{.label = std::string(kTrackedAxleNames[i]), .unit = unit.unit, .lines = {std::move(line)}};
    const double truth = truth_of(context, std::string(kTrackedAxleNames[i]));
    if (std::isfinite(truth)) {
      value.lines.push_back({.name = "truth at the start",
                             .y = std::vector<double>(h.time.size(), truth * unit.value),
                             .role = Role::kReference});
    }
    figure.panels.push_back(std::move(value));
    figure.panels.push_back({.label = "suspicion (1: alarm)",
                             .unit = "1",
                             .lines = {{.name = "suspicion", .y = h.suspicion}},
                             .height = 80});
    bool open = false;
    for (std::size_t k = 0; k < h.time.size(); ++k) {
      if (h.held[k] && !open)
        figure.spans.push_back({.from = h.time[k], .to = h.time[k], .label = "held", .tone = SpanTone::kMuted});
      if (h.held[k]) figure.spans.back().to = h.time[k];
      open = h.held[k];
    }
    for (const DriveChange& c : changes) {
      if (static_cast<std::size_t>(c.axle) == i) {
        figure.spans.push_back(
            {.from = c.change.began_s, .to = c.change.detected_s, .label = "change", .tone = SpanTone::kBad});
      }
    }
    section.blocks.emplace_back(std::move(figure));
  }
  document.sections.push_back(std::move(section));
  if (!drive.notes().empty())
    document.sections.push_back({.title = "Notes", .blocks = {List{drive.notes(), Tone::kNote}}});
  if (!estimate.warnings.empty())
    document.sections.push_back({.title = "Warnings", .blocks = {List{estimate.warnings, Tone::kWarning}}});
  return document;
}

}  // namespace veridyn::report
