#include "veridyn/report/aircraft_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>

#include "veridyn/report/figures/aircraft_figures.hpp"

namespace veridyn::report {
namespace {

using namespace veridyn::aircraft;
using estimation::Method;
using estimation::RegressionEstimate;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegree = std::numbers::pi / 180.0;

Status status_of(CoefficientVerdict verdict) {
  switch (verdict) {
    case CoefficientVerdict::kIdentified:
      return Status::kIdentified;
    case CoefficientVerdict::kNotExcited:
      return Status::kNotExcited;
    case CoefficientVerdict::kRejected:
      return Status::kRejected;
    case CoefficientVerdict::kSkipped:
      break;
  }
  return Status::kNone;
}

Status status_of(estimation::ParameterStatus status) { return status_from_name(estimation::to_string(status)); }

/// What a coefficient is to someone who flies.
std::string_view meaning(Coefficient c) {
  switch (c) {
    case Coefficient::kCL:
      return "lift";
    case Coefficient::kCD:
      return "drag";
    case Coefficient::kCY:
      return "side force";
    case Coefficient::kCl:
      return "rolling moment";
    case Coefficient::kCm:
      return "pitching moment";
    case Coefficient::kCn:
      return "yawing moment";
  }
  return "";
}

std::vector<std::string> meanings(std::span<const CoefficientResult> results, CoefficientVerdict verdict) {
  std::vector<std::string> names;
  for (const CoefficientResult& r : results) {
    if (r.verdict == verdict) names.push_back(fmt::format("{} ({})", meaning(r.coefficient), r.name));
  }
  return names;
}

Verdict verdict_of(const FlightAnalysis& analysis) {
  Verdict verdict;
  const auto good = meanings(analysis.coefficients, CoefficientVerdict::kIdentified);
  const auto bad = meanings(analysis.coefficients, CoefficientVerdict::kRejected);
  const auto calm = meanings(analysis.coefficients, CoefficientVerdict::kNotExcited);
  const auto skipped = meanings(analysis.coefficients, CoefficientVerdict::kSkipped);
  if (good.empty()) {
    verdict.level = Level::kBad;
    verdict.word = bad.empty() ? "Not excited" : "Rejected";
    verdict.headline = "No aerodynamic coefficient can be trusted from this flight: do not use a model from it.";
  } else if (bad.empty() && calm.empty() && skipped.empty()) {
    verdict.level = Level::kGood;
    verdict.word = "Identified";
    verdict.headline =
        "All aerodynamic coefficients were identified and predict a part of the flight that they had not seen.";
  } else {
    verdict.level = Level::kCaution;
    verdict.word = "Partly identified";
    verdict.headline = fmt::format("{} of {} aerodynamic coefficients were identified; the others must not be used.",
                                   good.size(), analysis.coefficients.size());
  }
  const auto line = [&](const char* word, const std::vector<std::string>& names) {
    if (!names.empty()) verdict.lines.push_back(fmt::format("{}: {}", word, fmt::join(names, ", ")));
  };
  line("Identified", good);
  line("Rejected", bad);
  line("Not excited by this flight", calm);
  line("Not attempted", skipped);
  for (const PredictedQuantity& q : analysis.validation.quantities) {
    verdict.lines.push_back(
        fmt::format("Flown over unseen data for {:.0f} s at a time, the model misses {} by {:.2g} {} on average",
                    analysis.validation.period_s, q.name == "airspeed" ? "airspeed" : q.name, q.fit.mae, q.unit));
  }
  return verdict;
}

std::vector<Fact> facts_of(const FlightStudy& study, const FlightAnalysis& analysis) {
  std::vector<Fact> facts{
      {"Aircraft", study.subject.name},
      {"Recording", study.truth ? "simulated from the study"
                                : std::filesystem::path(study.mapped.recording.source).filename().string()},
      {"Log", study.mapped.log_kind},
      {"Mass", fmt::format("{:.4g} kg", study.subject.mass)}};
  const TimeSpan span = study.mapped.recording.span();
  facts.push_back({"Recorded", fmt::format("{:.0f} s", span.duration())});
  double airborne = 0.0;
  for (const TimeSpan& s : analysis.segments.airborne) airborne += s.duration();
  if (airborne > 0.0) {
    facts.push_back({"In the air", fmt::format("{:.0f} s", airborne)});
    facts.push_back(
        {"Excited", fmt::format("{:.0f} s longitudinal, {:.0f} s lateral", analysis.segments.longitudinal.excited_s(),
                                analysis.segments.lateral.excited_s())});
  }
  if (!study.subject.sign_convention.empty()) facts.push_back({"Signs", study.subject.sign_convention});
  return facts;
}

Section coefficients_section(const FlightAnalysis& analysis) {
  Section section{.title = "Coefficients", .id = "coefficients"};
  Table table{
      .title = "Verdict per coefficient",
      .caption =
          "Explained: share of the coefficient's variance on the hold-out that the model accounts for (R squared). "
          "Theil: inequality coefficient, 0 perfect, below 0.3 good. Equation error: residual variance over what "
          "sensor "
          "noise alone would leave; 1 when the model is complete.",
      .columns = {{.name = "Coefficient"},
                  {.name = "Verdict"},
                  {.name = "Method"},
                  {.name = "identification", .unit = "%", .group = "explained"},
                  {.name = "hold-out", .unit = "%", .group = "explained"},
                  {.name = "Theil"},
                  {.name = "Equation error", .digits = 3}}};
  for (const CoefficientResult& r : analysis.coefficients) {
    const bool has = r.chosen.has_value();
    table.rows.push_back({.cells = {text_cell(fmt::format("{} {}", r.name, meaning(r.coefficient))),
                                    status_cell(status_of(r.verdict), to_string(r.verdict)),
                                    text_cell(has ? std::string(estimation::to_string(r.chosen->method)) : ""),
                                    number_cell(has ? 100.0 * r.identification_fit.r2 : kNaN, 1),
                                    number_cell(r.holdout_fit.count > 0 ? 100.0 * r.holdout_fit.r2 : kNaN, 1),
                                    number_cell(r.holdout_fit.count > 0 ? r.holdout_fit.theil : kNaN, 3),
                                    number_cell(has ? r.error_ratio : kNaN)},
                          .status = status_of(r.verdict)});
  }
  section.blocks.emplace_back(std::move(table));
  List reasons;
  for (const CoefficientResult& r : analysis.coefficients) reasons.items.push_back(r.reason);
  section.blocks.emplace_back(std::move(reasons));
  return section;
}

bool shown(const CoefficientResult& r) { return r.chosen && r.verdict == CoefficientVerdict::kIdentified; }

Table parameter_table(const FlightStudy& study, std::span<const CoefficientResult* const> results) {
  Table table{.title = "Parameters",
              .caption =
                  "95 % intervals from the covariance that allows for coloured residuals. A parameter whose interval "
                  "holds zero is "
                  "marked insignificant, not set to zero.",
              .columns = {{.name = "Parameter"},
                          {.name = "Status"},
                          {.name = "Value"},
                          {.name = "Sigma"},
                          {.name = "95 % low", .group = "interval"},
                          {.name = "95 % high", .group = "interval"},
                          {.name = "Unit"},
                          {.name = "t", .digits = 3}}};
  if (study.true_subject) table.columns.insert(table.columns.begin() + 6, {.name = "Truth"});
  for (const CoefficientResult* r : results) {
    for (std::size_t i = 0; i < r->chosen->parameters.size(); ++i) {
      const auto& p = r->chosen->parameters[i];
      Row row{.cells = {text_cell(p.name), status_cell(status_of(p.status)), measured_cell(p.value, p.sigma),
                        measured_cell(p.sigma, p.sigma), measured_cell(p.low95, p.sigma),
                        measured_cell(p.high95, p.sigma), text_cell(p.unit), number_cell(p.t)},
              .status = status_of(p.status)};
      if (study.true_subject) {
        const CoefficientModel* truth = study.true_subject->model.find(r->coefficient);
        const std::optional<double> value = truth ? truth->value_of(r->model.terms[i].expression) : std::nullopt;
        row.cells.insert(row.cells.begin() + 6, measured_cell(value.value_or(kNaN), p.sigma));
      }
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

IntervalPlot interval_plot(const FlightStudy& study, const CoefficientResult& r) {
  IntervalPlot plot{.title = fmt::format("{}: estimates of all methods", r.name), .reference_name = "truth"};
  for (const RegressionEstimate& e : r.comparison.estimates) plot.methods.emplace_back(estimation::to_string(e.method));
  for (std::size_t i = 0; i < r.model.size(); ++i) {
    IntervalRow row{.name = regressed_parameter_name(r.coefficient, r.model.terms[i], study.subject),
                    .unit = regressed_parameter_unit(r.coefficient, r.model.terms[i], study.subject)};
    for (const RegressionEstimate& e : r.comparison.estimates) {
      if (e.usable()) {
        const auto& p = e.parameters[i];
        row.estimates.push_back({p.value, p.low95, p.high95, status_of(p.status)});
      } else {
        row.estimates.push_back({kNaN, kNaN, kNaN, Status::kNone});
      }
    }
    if (study.true_subject) {
      if (const CoefficientModel* truth = study.true_subject->model.find(r.coefficient)) {
        row.reference = truth->value_of(r.model.terms[i].expression);
      }
    }
    plot.rows.push_back(std::move(row));
  }
  return plot;
}

Section parameters_section(const FlightStudy& study, const FlightAnalysis& analysis) {
  Section section{.title = "Parameters", .id = "parameters"};
  std::vector<const CoefficientResult*> usable;
  for (const CoefficientResult& r : analysis.coefficients) {
    if (shown(r)) usable.push_back(&r);
  }
  if (usable.empty()) {
    section.blocks.emplace_back(
        Paragraph{"No coefficient was identified, so there is no table of derivatives.", Tone::kNote});
    return section;
  }
  section.blocks.emplace_back(parameter_table(study, usable));
  for (const CoefficientResult* r : usable) section.blocks.emplace_back(interval_plot(study, *r));
  return section;
}

std::string unexcited_text(const RegressionEstimate& e) {
  std::vector<std::string> texts;
  for (const estimation::Direction& d : e.unexcited) texts.push_back(d.text);
  return texts.empty() ? "none" : fmt::format("{}", fmt::join(texts, "; "));
}

/// Estimators beside regression; no blocks when none was asked for.
Section other_estimators_section(const FlightAnalysis& analysis) {
  Section section{.title = "Other estimators", .id = "other-estimators"};
  const OtherEstimators& others = analysis.others;
  if (others.empty()) return section;
  section.blocks.emplace_back(Paragraph{
      "The same parameters on the same identification segments by other principles. Apart: difference to the "
      "recommended regression in units of the two standard errors together; both use the same data, so more than 3 is "
      "a "
      "contradiction and less than 1 is common. Output error knows turbulence only as far as the reconstruction found "
      "the gust; the frequency domain is biased by noise of the regressors as ordinary least squares is."});
  Table table{.title = "Comparison",
              .columns = {{.name = "Parameter"},
                          {.name = "Method"},
                          {.name = "Status"},
                          {.name = "Value"},
                          {.name = "Sigma"},
                          {.name = "95 % low", .group = "interval"},
                          {.name = "95 % high", .group = "interval"},
                          {.name = "Unit"},
                          {.name = "Apart", .unit = "sigma", .digits = 2}}};
  for (const CoefficientResult& r : analysis.coefficients) {
    if (!r.chosen) continue;
    for (const auto& p : r.chosen->parameters) {
      table.rows.push_back(
          {.cells = {text_cell(p.name), text_cell(std::string(estimation::to_string(r.chosen->method))),
                     status_cell(status_of(p.status)), measured_cell(p.value, p.sigma), measured_cell(p.sigma, p.sigma),
                     measured_cell(p.low95, p.sigma), measured_cell(p.high95, p.sigma), text_cell(p.unit),
                     number_cell(kNaN)}});
      for (const OtherParameter& other : others.parameters) {
        const estimation::MethodEstimate& e = other.estimate;
        if (e.parameter != p.name) continue;
        const bool contradicts = std::abs(other.apart_sigma) > 3.0;
        table.rows.push_back({.cells = {text_cell(""), text_cell(e.method), status_cell(status_of(e.status)),
                                        measured_cell(e.value, e.sigma), measured_cell(e.sigma, e.sigma),
                                        measured_cell(e.low95, e.sigma), measured_cell(e.high95, e.sigma),
                                        text_cell(e.unit), number_cell(other.apart_sigma)},
                              .status = contradicts ? Status::kCaution : Status::kNone});
      }
    }
  }
  if (!table.rows.empty()) section.blocks.emplace_back(std::move(table));
  for (const AxisOutputError& run : others.output_error) {
    if (!run.attempted || !run.estimate.usable()) continue;
    Table outputs{.title = fmt::format("Output error, {}: outputs", to_string(run.axis)),
                  .caption =
                      "Noise: estimated standard deviation of the residual. Lag 1: its autocorrelation at one "
                      "sample, 0 when white; the error bars are corrected for it.",
                  .columns = {{.name = "Output"},
                              {.name = "Noise", .digits = 3},
                              {.name = "Unit"},
                              {.name = "R2", .digits = 3},
                              {.name = "Theil", .digits = 3},
                              {.name = "Lag 1", .digits = 3}}};
    for (const estimation::OutputFit& o : run.estimate.outputs) {
      outputs.rows.push_back({.cells = {text_cell(o.name), number_cell(o.noise_sd), text_cell(o.unit),
                                        number_cell(o.fit.r2), number_cell(o.fit.theil), number_cell(o.lag1)}});
    }
    section.blocks.emplace_back(std::move(outputs));
  }
  section.blocks.emplace_back(List{.items = others.notes});
  return section;
}

/// How the terms were chosen; no blocks when the subject's were taken.
Section structure_section(const FlightAnalysis& analysis) {
  Section section{.title = "Choice of terms", .id = "structure"};
  for (const CoefficientResult& r : analysis.coefficients) {
    if (!r.structure) continue;
    Table table{.title = fmt::format("{}: history", name_of(r.coefficient)),
                .caption = r.structure->text,
                .columns = {{.name = "Action"},
                            {.name = "Term"},
                            {.name = "Terms"},
                            {.name = "F", .digits = 3},
                            {.name = "R2", .unit = "%", .digits = 4},
                            {.name = "Change", .unit = "%", .digits = 3},
                            {.name = "PRESS", .digits = 4},
                            {.name = "PSE", .digits = 4},
                            {.name = "Why not"}}};
    for (const estimation::StructureStep& s : r.structure->history) {
      table.rows.push_back(
          {.cells = {text_cell(std::string(estimation::to_string(s.action))), text_cell(s.term),
                     number_cell(static_cast<double>(s.terms), 0), number_cell(s.term.empty() ? kNaN : s.F),
                     number_cell(100.0 * s.r2), number_cell(100.0 * s.r2_change), number_cell(s.press),
                     number_cell(s.pse), text_cell(s.reason)}});
    }
    section.blocks.emplace_back(std::move(table));
  }
  return section;
}

Section excitation_section(const FlightAnalysis& analysis) {
  Section section{.title = "Excitation", .id = "excitation"};
  section.blocks.emplace_back(List{.items = {analysis.segments.longitudinal.text, analysis.segments.lateral.text}});
  Table table{.title = "Excited directions",
              .caption =
                  "Singular values of the regressors in units of their noise; a direction counts as excited above the "
                  "threshold "
                  "(S/n + 1) sqrt(N - n). Combinations of parameters that are not excited keep a wide error bar.",
              .columns = {{.name = "Coefficient"},
                          {.name = "Samples"},
                          {.name = "Threshold", .digits = 3},
                          {.name = "Singular values"},
                          {.name = "Not excited"},
                          {.name = "Condition", .digits = 3}}};
  for (const CoefficientResult& r : analysis.coefficients) {
    const RegressionEstimate* e = r.comparison.find(Method::kPcaGtls);
    if (e == nullptr) continue;
    std::vector<std::string> values;
    for (const double s : e->singular_values) values.push_back(fmt::format("{:.3g}", s));
    table.rows.push_back({.cells = {text_cell(r.name), number_cell(static_cast<double>(e->rows), 0),
                                    number_cell(e->threshold), text_cell(fmt::format("{}", fmt::join(values, ", "))),
                                    text_cell(unexcited_text(*e)), number_cell(e->condition_number)}});
  }
  if (!table.rows.empty()) section.blocks.emplace_back(std::move(table));
  for (const CoefficientResult& r : analysis.coefficients) {
    if (!shown(r)) continue;
    const Eigen::MatrixXd& P = r.chosen->covariance;
    Matrix matrix{.title = fmt::format("{}: correlation of the parameters", r.name)};
    for (const auto& p : r.chosen->parameters) matrix.row_names.push_back(p.name);
    matrix.column_names = matrix.row_names;
    for (Eigen::Index i = 0; i < P.rows(); ++i) {
      std::vector<double> row;
      for (Eigen::Index j = 0; j < P.cols(); ++j) row.push_back(P(i, j) / std::sqrt(P(i, i) * P(j, j)));
      matrix.values.push_back(std::move(row));
    }
    section.blocks.emplace_back(std::move(matrix));
  }
  return section;
}

Section residual_section(const FlightAnalysis& analysis) {
  Section section{.title = "Residuals", .id = "residuals"};
  Table table{
      .title = "Honesty checks",
      .caption =
          "What would make an estimate look better than it is. A coefficient whose check fails is not recommended.",
      .columns = {{.name = "Coefficient"}, {.name = "Check"}, {.name = "Result"}, {.name = "Finding"}}};
  for (const CoefficientResult& r : analysis.coefficients) {
    for (const estimation::HonestyCheck& check : r.comparison.checks) {
      table.rows.push_back(
          {.cells = {text_cell(r.name), text_cell(check.name),
                     status_cell(check.passed ? Status::kGood : Status::kCaution), text_cell(check.text)}});
    }
  }
  if (!table.rows.empty()) section.blocks.emplace_back(std::move(table));
  for (const CoefficientResult& r : analysis.coefficients) {
    if (!r.chosen || r.residual_autocorrelation.value.empty()) continue;
    section.blocks.emplace_back(residual_autocorrelation_plot(r));
    section.blocks.emplace_back(residual_normal_plot(r));
  }
  return section;
}

Section validation_section(const FlightAnalysis& analysis) {
  Section section{.title = "Validation on unseen data", .id = "validation"};
  const Validation& v = analysis.validation;
  section.blocks.emplace_back(Paragraph{v.text, v.available() ? Tone::kPlain : Tone::kNote});
  Table table{
      .title = "Prediction",
      .caption =
          "MAE: mean absolute error, RMSE: root mean square error, R2: share of the variance explained, Theil: "
          "inequality "
          "coefficient (0 perfect). Coefficients are compared sample by sample; airspeed, alpha and beta are flown.",
      .columns = {{.name = "Quantity"},
                  {.name = "MAE", .digits = 3},
                  {.name = "RMSE", .digits = 3},
                  {.name = "R2", .digits = 3},
                  {.name = "Theil", .digits = 3},
                  {.name = "Unit"},
                  {.name = "Samples"}}};
  const auto row = [&](std::string name, const numerics::FitMeasures& fit, const std::string& unit, Status status) {
    table.rows.push_back(
        {.cells = {text_cell(std::move(name)), number_cell(fit.mae), number_cell(fit.rmse), number_cell(fit.r2),
                   number_cell(fit.theil), text_cell(unit), number_cell(static_cast<double>(fit.count), 0)},
         .status = status});
  };
  for (const PredictedQuantity& q : v.quantities) row(q.name, q.fit, q.unit, Status::kNone);
  for (const CoefficientResult& r : analysis.coefficients) {
    if (r.holdout_fit.count > 0) row(r.name, r.holdout_fit, "1", status_of(r.verdict));
  }
  if (!table.rows.empty()) section.blocks.emplace_back(std::move(table));
  for (TimeSeries& figure : validation_figures(v)) section.blocks.emplace_back(std::move(figure));
  return section;
}

Section rejected_section(const FlightStudy& study, const FlightAnalysis& analysis) {
  Section section{.title = "Rejected estimates (do not use)", .id = "rejected", .folded = true};
  section.blocks.emplace_back(
      Paragraph{"For those who want to see what went wrong. These numbers are not the aircraft's.", Tone::kWarning});
  std::size_t count = 0;
  for (const CoefficientResult& r : analysis.coefficients) {
    if (r.verdict != CoefficientVerdict::kRejected || !r.chosen) continue;
    section.blocks.emplace_back(Paragraph{r.reason});
    section.blocks.emplace_back(interval_plot(study, r));
    ++count;
  }
  if (count == 0) section.blocks.clear();
  return section;
}

Table sensor_error_table(const Reconstruction& rec) {
  Table table{.title = "Errors of the sensors and of the model",
              .caption =
                  "What was to be estimated: how much of it this flight determines, and with what it is entangled. "
                  "Information: share of the precision that the flight adds to what was assumed beforehand.",
              .columns = {{.name = "Error"},
                          {.name = "Value", .digits = 3},
                          {.name = "Sigma", .digits = 2},
                          {.name = "Assumed beforehand", .digits = 3},
                          {.name = "Unit"},
                          {.name = "Information", .unit = "%", .digits = 3},
                          {.name = "Most correlated with"},
                          {.name = "Correlation", .digits = 2},
                          {.name = "Verdict"}}};
  for (const SensorErrorReport& e : rec.sensor_errors) {
    const Status status = e.observability == Observability::kObservable ? Status::kGood
                          : e.observability == Observability::kWeak     ? Status::kCaution
                                                                        : Status::kBad;
    const std::string unit = shown_unit(e.unit);
    table.rows.push_back(
        {.cells = {text_cell(e.name), number_cell(aircraft::shown(e.value, e.unit)),
                   number_cell(aircraft::shown(e.sigma, e.unit)), number_cell(aircraft::shown(e.prior_sigma, e.unit)),
                   text_cell(unit.empty() ? unit : unit.substr(1)), number_cell(100.0 * e.information),
                   text_cell(e.correlated_with), number_cell(e.correlation),
                   status_cell(status, to_string(e.observability))}});
  }
  return table;
}

/// Error over signal variance, the source's figure, as numbers.
Table comparison_table(const Reconstruction& rec) {
  Table table{.title = "Model-free against model-based filter",
              .caption =
                  "Root mean square errors against the truth of the simulated flight, the information bound of a "
                  "filter that knows the aircraft, and the share of the signal's variance that is error.",
              .columns = {{.name = "Quantity"},
                          {.name = "Unit"},
                          {.name = "Model-free filter", .digits = 3},
                          {.name = "smoother", .digits = 3},
                          {.name = "Model-based filter", .digits = 3},
                          {.name = "smoother", .digits = 3},
                          {.name = "Bound, filter", .digits = 3},
                          {.name = "smoother", .digits = 3},
                          {.name = "Error/signal, model-free", .unit = "%", .digits = 3},
                          {.name = "model-based", .unit = "%", .digits = 3}}};
  for (const FilterError& e : rec.comparison) {
    const auto value = [&](double v) { return number_cell(v > 0.0 ? aircraft::shown(v, e.unit) : std::nan("")); };
    const auto share = [&](double rms) { return number_cell(100.0 * std::pow(rms / e.signal_sd, 2)); };
    const std::string unit = shown_unit(e.unit);
    table.rows.push_back(
        {.cells = {text_cell(e.quantity), text_cell(unit.substr(unit.empty() ? 0 : 1)), value(e.model_free.filter_rms),
                   value(e.model_free.smoother_rms), value(e.model_based.filter_rms), value(e.model_based.smoother_rms),
                   value(e.model_based.filter_bound), value(e.model_based.smoother_bound),
                   share(e.model_free.smoother_rms), share(e.model_based.smoother_rms)}});
  }
  return table;
}

Section sensors_section(const FlightStudy& study, const FlightAnalysis& analysis) {
  Section section{.title = "Sensors and state estimation", .id = "sensors"};
  const Reconstruction& rec = analysis.reconstruction;
  FactList facts{{{"Filter", to_string(rec.filter)},
                  {"Turbulence assumed", rec.turbulence_origin},
                  {"Air density from", rec.density_origin}}};
  if (rec.guard) facts.facts.push_back({"Guard", rec.guard->statement});
  section.blocks.emplace_back(std::move(facts));
  Table channels{
      .title = "Channels",
      .columns = {
          {.name = "Channel"}, {.name = "From"}, {.name = "Rate", .unit = "Hz", .digits = 3}, {.name = "Note"}}};
  for (const ChannelOrigin& o : study.mapped.origins) {
    channels.rows.push_back(
        {.cells = {text_cell(o.channel), text_cell(o.source), number_cell(o.rate_Hz), text_cell(o.note)}});
  }
  section.blocks.emplace_back(std::move(channels));
  if (!analysis.delays.empty()) {
    Table delays{.title = "Delays",
                 .caption = "Positive: the sensor reports late.",
                 .columns = {{.name = "Group"},
                             {.name = "Compared with"},
                             {.name = "Delay", .unit = "ms"},
                             {.name = "Sigma", .unit = "ms"},
                             {.name = "Correlation", .digits = 2},
                             {.name = "Result"}}};
    for (const DelayReport& d : analysis.delays) {
      delays.rows.push_back(
          {.cells = {text_cell(d.group), text_cell(d.reference), number_cell(1e3 * d.delay_s, 1),
                     number_cell(1e3 * d.sigma_s, 1), number_cell(d.correlation), text_cell(d.text)}});
    }
    section.blocks.emplace_back(std::move(delays));
  }
  Table sensors{.title = "Innovations",
                .caption =
                    "NIS: mean square of the innovations in units of what the filter expected; 1 when the assumed "
                    "noise is right, above when "
                    "the sensor is worse than assumed. Lag 1: autocorrelation, 0 when white.",
                .columns = {{.name = "Sensor"},
                            {.name = "Assumed sigma", .digits = 3},
                            {.name = "Unit"},
                            {.name = "Samples"},
                            {.name = "Refused"},
                            {.name = "NIS", .digits = 3},
                            {.name = "Lag 1", .digits = 2}}};
  for (const SensorReport& s : rec.sensors) {
    const double scale = s.unit == "rad" ? 1.0 / kDegree : 1.0;
    sensors.rows.push_back(
        {.cells = {text_cell(s.channel), number_cell(s.sigma * scale), text_cell(s.unit == "rad" ? "deg" : s.unit),
                   number_cell(static_cast<double>(s.innovations.count), 0),
                   number_cell(static_cast<double>(s.innovations.rejected), 0), number_cell(s.innovations.nis),
                   number_cell(s.innovations.lag1)}});
  }
  section.blocks.emplace_back(std::move(sensors));
  Table quantities{.title = "What the sensors can tell",
                   .columns = {{.name = "Quantity"},
                               {.name = "Sigma", .digits = 3},
                               {.name = "Assumed beforehand", .digits = 3},
                               {.name = "Unit"},
                               {.name = "Verdict"},
                               {.name = "In words"}}};
  for (const QuantityReport& q : rec.quantities) {
    const double scale = q.unit == "rad" ? 1.0 / kDegree : 1.0;
    const Status status = q.observability == Observability::kObservable ? Status::kGood
                          : q.observability == Observability::kWeak     ? Status::kCaution
                                                                        : Status::kBad;
    quantities.rows.push_back(
        {.cells = {text_cell(q.quantity), number_cell(q.sigma * scale), number_cell(q.prior_sigma * scale),
                   text_cell(q.unit == "rad" ? "deg" : q.unit), status_cell(status, to_string(q.observability)),
                   text_cell(q.statement)}});
  }
  section.blocks.emplace_back(std::move(quantities));
  if (!rec.sensor_errors.empty()) section.blocks.emplace_back(sensor_error_table(rec));
  if (!rec.comparison.empty()) section.blocks.emplace_back(comparison_table(rec));
  return section;
}

Section uncertainty_section(const UncertaintyReport& report) {
  Section section{.title = "Uncertainty of the measured coefficients", .id = "uncertainty"};
  Table table{
      .title = "Error of one measured coefficient",
      .caption =
          "Propagation of distributions (JCGM 101): 95 % of the errors lie between low and high; sigma is the larger "
          "end over 1.96. Beside it the linear law of propagation, apart for what differs from sample to sample "
          "(sensors) and what all samples share (mass, geometry, inertia: subject.sigma). Range: standard deviation of "
          "the coefficient itself over the operating range.",
      .columns = {{.name = "Coefficient"},
                  {.name = "sigma", .group = "Monte Carlo"},
                  {.name = "95 % low", .group = "Monte Carlo"},
                  {.name = "95 % high", .group = "Monte Carlo"},
                  {.name = "mean", .digits = 2, .group = "Monte Carlo"},
                  {.name = "sigma", .group = "linear"},
                  {.name = "of sensors", .group = "linear"},
                  {.name = "of the aircraft's constants", .group = "linear"},
                  {.name = "Range", .digits = 3}}};
  for (const CoefficientUncertainty& c : report.coefficients) {
    const double sigma = c.error.sigma;
    table.rows.push_back(
        {.cells = {text_cell(std::string(name_of(c.coefficient))), measured_cell(sigma, sigma),
                   measured_cell(c.error.low, sigma), measured_cell(c.error.high, sigma), number_cell(c.error.mean),
                   measured_cell(c.sigma_linear, sigma), measured_cell(c.sigma_sensors, sigma),
                   measured_cell(c.sigma_body, sigma), number_cell(c.range)}});
  }
  section.blocks.emplace_back(std::move(table));
  section.blocks.emplace_back(Paragraph{report.text + "."});
  return section;
}

void add_warnings(Document& document, const std::vector<std::string>& warnings) {
  if (warnings.empty()) return;
  Section section{.title = "Warnings", .id = "warnings"};
  section.blocks.emplace_back(List{.items = warnings, .tone = Tone::kWarning});
  document.sections.push_back(std::move(section));
}

Section method_section(const FlightStudy& study, const FlightAnalysis& analysis) {
  Section section{.title = "How it was done", .id = "method"};
  const FlightSignals& s = analysis.signals;
  std::vector<Fact> facts{
      {"Study", study.name},
      {"Seed", std::to_string(study.seed)},
      {"Common grid", fmt::format("{:.0f} Hz, every {}. sample regressed on", s.grid.rate_Hz(), s.stride)},
      {"Pass band", fmt::format("0 to {:.1f} Hz, zero phase", s.filter.pass_Hz)},
      {"Hold-out", fmt::format("{:.0f} % of the excited time, in blocks of {:.0f} s", 100.0 * study.segments.holdout,
                               study.segments.block_s)},
      {"Estimator", study.identify.method}};
  for (const FlightSignal which : {FlightSignal::kAlpha, FlightSignal::kBeta, FlightSignal::kP, FlightSignal::kAz}) {
    const GridSignal& signal = s[which];
    const bool angle = which != FlightSignal::kAz;
    facts.push_back({fmt::format("{} regressed on", kFlightSignalNames[static_cast<std::size_t>(which)]),
                     fmt::format("{}, error {:.3g} {}", signal.origin, angle ? signal.sigma / kDegree : signal.sigma,
                                 which == FlightSignal::kP ? "deg/s" : (angle ? "deg" : "m/s^2"))});
  }
  section.blocks.emplace_back(FactList{std::move(facts)});
  section.blocks.emplace_back(
      Paragraph{"Sensors are brought onto one clock; a model-free extended Kalman filter with Dryden gust states and "
                "its fixed-interval smoother give "
                "airspeed, flow angles and wind; all signals pass one zero-phase filter; coefficients follow from the "
                "rigid-body equations; each is "
                "estimated by ordinary, total and generalised total least squares on the same samples, with the "
                "regressors' errors propagated from "
                "the sensors; what is recommended has passed the checks above and predicts the hold-out."});
  return section;
}

}  // namespace

Document identification_report(const FlightStudy& study, const FlightAnalysis& analysis,
                               const AircraftReportContext& context) {
  Document document;
  document.title = fmt::format("{}: aerodynamic model", study.subject.name);
  document.subtitle = context.verb == "validate" ? "A given estimate tried on this flight" : "Identified from flight";
  document.verdict = verdict_of(analysis);
  document.facts = facts_of(study, analysis);
  document.generator = fmt::format("Made with {}", context.program);
  document.sections.push_back(coefficients_section(analysis));
  if (context.verb != "validate") document.sections.push_back(parameters_section(study, analysis));
  for (Section section : {other_estimators_section(analysis), structure_section(analysis)})
    if (!section.blocks.empty()) document.sections.push_back(std::move(section));
  document.sections.push_back(validation_section(analysis));
  document.sections.push_back(flight_section(study, analysis));
  document.sections.push_back(coefficient_series_section(analysis));
  if (context.verb != "validate") {
    document.sections.push_back(excitation_section(analysis));
    document.sections.push_back(residual_section(analysis));
  }
  if (analysis.uncertainty.available()) document.sections.push_back(uncertainty_section(analysis.uncertainty));
  document.sections.push_back(sensors_section(study, analysis));
  add_warnings(document, analysis.estimate.warnings);
  if (Section rejected = rejected_section(study, analysis); !rejected.blocks.empty())
    document.sections.push_back(std::move(rejected));
  document.sections.push_back(method_section(study, analysis));
  return document;
}

Document reconstruction_report(const FlightStudy& study, const FlightAnalysis& analysis,
                               const AircraftReportContext& context) {
  Document document;
  document.title = fmt::format("{}: motion through the air", study.subject.name);
  document.subtitle = "Airspeed, flow angles and wind from the recording";
  document.facts = facts_of(study, analysis);
  document.generator = fmt::format("Made with {}", context.program);
  std::vector<std::string> weak;
  for (const QuantityReport& q : analysis.reconstruction.quantities) {
    const bool air_data =
        q.quantity == "airspeed" || q.quantity == "alpha" || q.quantity == "beta" || q.quantity.starts_with("wind");
    if (air_data && q.observability != Observability::kObservable) weak.push_back(q.quantity);
  }
  document.verdict.level = weak.empty() ? Level::kGood : Level::kCaution;
  document.verdict.word = weak.empty() ? "Observable" : "Partly observable";
  document.verdict.headline =
      weak.empty()
          ? "Airspeed, flow angles and wind are determined by the sensors of this flight."
          : fmt::format("The sensors of this flight do not determine {}: mind the bands.", fmt::join(weak, ", "));
  document.sections.push_back(flight_section(study, analysis));
  document.sections.push_back(sensors_section(study, analysis));
  add_warnings(document, analysis.reconstruction.warnings);
  return document;
}

}  // namespace veridyn::report
