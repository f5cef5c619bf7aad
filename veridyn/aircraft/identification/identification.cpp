#include "veridyn/aircraft/identification/identification.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/identification/body_error.hpp"
#include "veridyn/aircraft/identification/coefficient_evidence.hpp"
#include "veridyn/aircraft/identification/coefficient_rows.hpp"
#include "veridyn/aircraft/identification/error_variance.hpp"
#include "veridyn/aircraft/identification/sensor_doubt.hpp"
#include "veridyn/aircraft/model/estimated_subject.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/judgement/agreement.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Method;
using estimation::ParameterStatus;
using estimation::RegressionComparison;
using estimation::RegressionData;
using estimation::RegressionEstimate;
using estimation::RegressionOptions;
using estimation::StructureMethod;
using internal::complete;
using internal::needed_signals;

/// Factor on the standard deviation within which the noise of the sensors is known.
constexpr double kNoiseTolerance = 2.0;

/// Predicted and measured coefficient over rows.
numerics::FitMeasures fit_on(const RegressionData& data, const Eigen::VectorXd& theta) {
  const Eigen::VectorXd model = data.regressors * theta;
  return numerics::fit_measures({data.regressand.data(), static_cast<std::size_t>(data.regressand.size())},
                                {model.data(), static_cast<std::size_t>(model.size())});
}

/// The estimate by the given method, or the recommended one; null where there is none.
const RegressionEstimate* choose(const RegressionComparison& comparison, std::optional<Method> method) {
  const auto usable = [&](Method m) {
    const RegressionEstimate* estimate = comparison.find(m);
    return estimate != nullptr && estimate->usable() ? estimate : nullptr;
  };
  if (method) return usable(*method);
  if (const RegressionEstimate* best = comparison.best()) return best;
  // What it would have been, so that the report can show it with the reason for its rejection.
  for (const Method fallback : {Method::kPcaGtls, Method::kGtls, Method::kOls}) {
    if (const RegressionEstimate* estimate = usable(fallback)) return estimate;
  }
  return nullptr;
}

/// Of two independent estimates of the same parameters.
estimation::Agreement agreement_of(const RegressionEstimate& a, const RegressionEstimate& b) {
  return estimation::agreement(a.theta - b.theta, a.covariance + b.covariance);
}

/// View of what coefficients are identified from, and how.
struct FlightView {
  const FlightSignals& signals;
  const Segments& segments;
  const Subject& subject;
  const IdentifyOptions& options;
  std::span<const FlightEvidence> recording = {};

  [[nodiscard]] const AxisSegments& axis_of_model(const CoefficientModel& model) const {
    return segments.of(axis_of(model.coefficient));
  }
  [[nodiscard]] RegressionOptions regression_options() const {
    RegressionOptions regression;
    regression.significance = options.significance;
    regression.signal_to_noise = options.signal_to_noise;
    return regression;
  }
};

/// What is known of a coefficient before anything is estimated; `reason` is empty unless nothing can be.
CoefficientResult describe_coefficient(const CoefficientModel& model, const FlightView& flight) {
  CoefficientResult result;
  result.coefficient = model.coefficient;
  result.name = regressed_name(model.coefficient, flight.subject);
  result.per_unit_inertia = per_unit_inertia(model.coefficient, flight.subject);
  result.axis = axis_of(model.coefficient);
  result.model = model;
  result.row_interval_s = flight.signals.grid.step * static_cast<double>(flight.signals.stride);
  result.reason = identification_obstacle(model, flight.signals, flight.subject);
  return result;
}

/// A model whose terms were chosen among candidates; without a search where there was too little to choose from.
struct ChosenTerms {
  CoefficientModel model;
  std::optional<estimation::StructureSearch> search;
};

/// By least squares on the identification rows.
ChosenTerms choose_terms(const CoefficientModel& given, StructureMethod method, const FlightView& flight) {
  const Coefficient c = given.coefficient;
  CoefficientModel all{c, flight.options.candidates[c], {}};
  if (all.terms.empty()) all.terms = default_candidates(given);
  // What the log does not have cannot be chosen.
  std::erase_if(all.terms, [&](const Term& term) {
    const CoefficientModel single{c, {term}, {kNaN}};
    return !identification_obstacle(single, flight.signals, flight.subject).empty();
  });
  all.values.assign(all.terms.size(), kNaN);
  const RegressionData data =
      coefficient_data(all, flight.signals, flight.axis_of_model(given).identification, flight.subject);
  if (all.terms.empty() || data.rows() < static_cast<Eigen::Index>(10 * all.size())) return {given, std::nullopt};
  estimation::StructureOptions options;
  options.method = method;
  options.significance = flight.options.significance;
  estimation::StructureSearch search = estimation::search_structure(data, options);
  if (search.selected.empty()) return {given, std::move(search)};
  CoefficientModel chosen{c, {}, {}};
  for (const Eigen::Index j : search.selected) chosen.terms.push_back(all.terms[at(j)]);
  chosen.values.assign(chosen.terms.size(), kNaN);
  return {std::move(chosen), std::move(search)};
}

/// The parameters of a model by all methods on the identification rows.
struct CoefficientFit {
  CoefficientModel model;  ///< values are the chosen estimate's, where there is one
  RegressionData data;
  RegressionComparison comparison;
  std::optional<RegressionEstimate> chosen;
  double error_ratio = 0.0;
  bool enough_rows = false;
};

CoefficientFit fit_coefficient(CoefficientModel model, const FlightView& flight) {
  CoefficientFit fit;
  fit.model = std::move(model);
  fit.data =
      coefficient_data(fit.model, flight.signals, flight.axis_of_model(fit.model).identification, flight.subject);
  fit.enough_rows = fit.data.rows() >= static_cast<Eigen::Index>(10 * fit.model.size());
  if (!fit.enough_rows) return fit;
  const auto n = fit.data.parameters();
  const RegressionData by_sensors = fit.data;
  const EquationError error = equation_error(fit.data);
  fit.data.error_covariance(n, n) = error.variance;
  fit.error_ratio = error.ratio;
  fit.comparison = estimation::compare(fit.data, flight.regression_options());
  if (const RegressionEstimate* chosen = choose(fit.comparison, flight.options.method)) {
    fit.chosen = *chosen;
    // The errors of the regressors explain all: then the residual is compared with theirs and the sensors' of z.
    if (!(fit.error_ratio > 0.0)) fit.error_ratio = residual_ratio(by_sensors, chosen->theta);
    for (std::size_t i = 0; i < fit.model.size(); ++i)
      fit.model.values[i] = chosen->theta(static_cast<Eigen::Index>(i));
  }
  return fit;
}

/// The terms whose parameters are significant, the constant always among them.
CoefficientModel significant_terms(const CoefficientModel& model, const RegressionEstimate& estimate) {
  CoefficientModel kept{model.coefficient, {}, {}};
  for (std::size_t i = 0; i < model.size(); ++i) {
    const bool significant = estimate.parameters[i].status == ParameterStatus::kIdentified;
    if (!significant && !model.terms[i].constant()) continue;
    kept.terms.push_back(model.terms[i]);
    kept.values.push_back(kNaN);
  }
  return kept;
}

/// What the study gave for the terms of a model, where it gave all of them.
std::optional<Eigen::VectorXd> start_values(const CoefficientModel& model, const Subject& subject) {
  const CoefficientModel* given = subject.model.find(model.coefficient);
  if (given == nullptr) return std::nullopt;
  Eigen::VectorXd values(signed_index(model.size()));
  for (std::size_t i = 0; i < model.size(); ++i)
    values(static_cast<Eigen::Index>(i)) = given->value_of(model.terms[i].expression).value_or(kNaN);
  return values.allFinite() ? std::optional(values) : std::nullopt;
}

CoefficientChecks check_estimate(const CoefficientFit& fit, double row_interval_s, const FlightView& flight) {
  const RegressionEstimate& chosen = *fit.chosen;
  CoefficientChecks checks;
  checks.error_ratio = fit.error_ratio;
  checks.identification_fit = fit_on(fit.data, chosen.theta);
  const double beyond_sensors = std::max(0.0, 1.0 - kNoiseTolerance * kNoiseTolerance / fit.error_ratio);
  checks.unmodelled_share = (1.0 - checks.identification_fit.r2) * beyond_sensors;
  const Eigen::VectorXd residual = fit.data.regressand - fit.data.regressors * chosen.theta;
  const auto lags = static_cast<std::size_t>(std::clamp(3.0 / row_interval_s, 10.0, 200.0));
  checks.residual_autocorrelation =
      numerics::autocorrelation({residual.data(), static_cast<std::size_t>(residual.size())}, lags, fit.data.segment);

  RegressionData unseen =
      coefficient_data(fit.model, flight.signals, flight.axis_of_model(fit.model).holdout, flight.subject);
  checks.has_holdout = unseen.rows() >= static_cast<Eigen::Index>(10 * fit.model.size());
  if (!checks.has_holdout) return checks;
  checks.holdout_fit = fit_on(unseen, chosen.theta);
  constexpr double kBand95 = 1.96;
  const double band = kBand95 * std::sqrt(residual.squaredNorm() / static_cast<double>(residual.size()));
  const Eigen::ArrayXd missed = (unseen.regressand - unseen.regressors * chosen.theta).array().abs();
  checks.outside_bands = static_cast<double>((missed > band).count()) / static_cast<double>(missed.size());
  if (const std::optional<Eigen::VectorXd> start = start_values(fit.model, flight.subject))
    checks.error_over_start = checks.holdout_fit.rmse / fit_on(unseen, *start).rmse;
  const auto n = unseen.parameters();
  checks.holdout_ratio = residual_ratio(unseen, chosen.theta);
  unseen.error_covariance(n, n) = fit.data.error_covariance(n, n);
  const RegressionEstimate again = estimation::estimate(unseen, chosen.method, flight.regression_options());
  if (again.usable()) {
    const estimation::Agreement agreement = agreement_of(chosen, again);
    checks.contradiction_p = agreement.p;
    checks.scatter = agreement.ratio;
  }
  return checks;
}

/// See body_sensitivity: each of the aircraft's constants is changed and the parameters estimated again.
Eigen::MatrixXd sensitivity_to_body(const CoefficientFit& fit, const FlightView& flight) {
  return body_sensitivity(flight.subject, fit.chosen->theta.size(), [&](const Subject& changed) {
    RegressionData data =
        coefficient_data(fit.model, flight.signals, flight.axis_of_model(fit.model).identification, changed);
    const auto n = data.parameters();
    data.error_covariance(n, n) = equation_error(data).variance;
    const RegressionEstimate estimate = estimation::estimate(data, fit.chosen->method, flight.regression_options());
    return estimate.usable() ? estimate.theta : Eigen::VectorXd();
  });
}

/// See doubt_sensitivity: of the doubts that are part of the interval, or of those alongside it.
Eigen::MatrixXd doubts_of_air_data(const CoefficientFit& fit, const FlightView& flight, bool in_interval) {
  std::vector<SignalDoubt> doubts;
  for (const FlightEvidence& row : flight.recording)
    if (row.doubt && row.doubt->in_interval == in_interval && row.bears_on(fit.model.coefficient))
      doubts.push_back(*row.doubt);
  return doubt_sensitivity(flight.signals, doubts, fit.chosen->theta, [&](const FlightSignals& changed) {
    RegressionData data =
        coefficient_data(fit.model, changed, flight.axis_of_model(fit.model).identification, flight.subject);
    const auto n = data.parameters();
    data.error_covariance(n, n) = equation_error(data).variance;
    const RegressionEstimate estimate = estimation::estimate(data, fit.chosen->method, flight.regression_options());
    return estimate.usable() ? estimate.theta : Eigen::VectorXd();
  });
}

/// A verdict and the sentence that explains it.
struct ExplainedVerdict {
  estimation::GroupVerdict verdict;
  std::string reason;
};

/// Why the parameters of an estimate are no physical constants.
std::string objection(const CoefficientResult& judged, const CoefficientChecks& checks) {
  const std::vector<std::string>& why = judged.judgement.parameters.decided_by;
  const std::string first = why.empty() ? "its parameters could not be judged" : why.front();
  if (estimation::verdict_of(judged.judgement) != estimation::GroupVerdict::kEffective)
    return fmt::format("{} is rejected: {}", judged.name, first);
  return fmt::format("{} predicts {:.0f} % of the hold-out, but its values are no physical constants: {}", judged.name,
                     100.0 * checks.holdout_fit.r2, first);
}

/// Of an estimate that may be used. `dominant` is the constant of the aircraft that makes up most of its error bars.
ExplainedVerdict explain(const CoefficientResult& described, const RegressionEstimate& chosen,
                         const CoefficientChecks& checks, const std::string& dominant) {
  const std::string& name = described.name;
  const auto with_status = [&](ParameterStatus status) {
    std::vector<std::string> names;
    for (const auto& p : chosen.parameters) {
      if (p.status == status) names.push_back(p.name);
    }
    return names;
  };
  const std::vector<std::string> unexcited = with_status(ParameterStatus::kNotExcited);
  const std::vector<std::string> insignificant = with_status(ParameterStatus::kInsignificant);
  if (with_status(ParameterStatus::kIdentified).empty() && !unexcited.empty())
    return {estimation::GroupVerdict::kNotExcited, fmt::format("{} is not excited: {}", name, chosen.message)};
  std::string reason = checks.has_holdout
                           ? fmt::format("{} is identified by {}: it explains {:.0f} % of the hold-out", name,
                                         estimation::to_string(chosen.method), 100.0 * checks.holdout_fit.r2)
                           : fmt::format("{} is identified by {}, but there was no hold-out to validate it on", name,
                                         estimation::to_string(chosen.method));
  if (!dominant.empty()) reason += fmt::format("; its error bars are mostly those of {}", dominant);
  if (described.per_unit_inertia)
    reason += "; per unit inertia, which is not given (inertial coupling of a flat body assumed)";
  if (!insignificant.empty())
    reason += fmt::format("; not distinguishable from zero: {}", fmt::join(insignificant, ", "));
  if (!unexcited.empty()) reason += fmt::format("; not excited: {}", fmt::join(unexcited, ", "));
  if (described.judgement.parameters.grade == estimation::Grade::kWithCare)
    reason += fmt::format("; with care: {}", fmt::join(described.judgement.parameters.decided_by, "; "));
  return {estimation::GroupVerdict::kIdentified, std::move(reason)};
}

ExplainedVerdict not_excited(const std::string& name, const CoefficientFit& fit, const AxisSegments& axis) {
  return {estimation::GroupVerdict::kNotExcited,
          axis.excited.empty() ? fmt::format("{} is not excited: {}", name, axis.text)
                               : fmt::format("{} has only {} usable samples on its segments, {} are needed", name,
                                             fit.data.rows(), 10 * fit.model.size())};
}

/// Measured and modelled coefficient while airborne; see CoefficientResult.
struct CoefficientSeries {
  std::vector<double> time, measured, modelled;
};

CoefficientSeries series_of(const CoefficientModel& model, const FlightView& flight) {
  CoefficientSeries series;
  const FlightSignals& signals = flight.signals;
  const std::vector<FlightSignal> needed = needed_signals(model);
  const bool estimated = model.known();
  for (const TimeSpan& span : flight.segments.airborne) {
    const auto [begin, end] = signals.indices(span);
    for (std::size_t k = begin; k < end; k += signals.stride) {
      const FlightSample<double> sample = signals.sample(k);
      series.time.push_back(signals.grid.at(k));
      if (!complete(sample, needed)) {
        series.measured.push_back(kNaN);
        series.modelled.push_back(kNaN);
        continue;
      }
      const double torque = signals.torque.empty() ? 0.0 : signals.torque[k];
      const double rho = signals.air_density[k];
      series.measured.push_back(select(regressed_coefficients(sample, flight.subject, rho, torque), model.coefficient));
      series.modelled.push_back(estimated ? model.linear(aero_variables(sample, flight.subject, rho)) : kNaN);
    }
  }
  return series;
}

CoefficientResult with_series(CoefficientResult result, CoefficientSeries series) {
  result.time = std::move(series.time);
  result.measured = std::move(series.measured);
  result.modelled = std::move(series.modelled);
  return result;
}

/// One coefficient: terms, estimates, checks, verdict.
CoefficientResult identify_coefficient(const CoefficientModel& given, const FlightView& flight) {
  const IdentifyOptions& options = flight.options;
  CoefficientResult result = describe_coefficient(given, flight);
  if (!result.reason.empty()) return result;
  ChosenTerms terms =
      options.structure ? choose_terms(given, *options.structure, flight) : ChosenTerms{given, std::nullopt};
  result.structure = std::move(terms.search);
  CoefficientFit fit = fit_coefficient(std::move(terms.model), flight);
  if (fit.chosen && options.refit_significant) {
    CoefficientModel kept = significant_terms(fit.model, *fit.chosen);
    if (kept.size() > 0 && kept.size() < fit.model.size()) fit = fit_coefficient(std::move(kept), flight);
  }

  ExplainedVerdict verdict{estimation::GroupVerdict::kRejected,
                           fmt::format("{}: {}", result.name, fit.comparison.reason)};
  if (!fit.enough_rows) verdict = not_excited(result.name, fit, flight.axis_of_model(given));
  if (fit.chosen) {
    const CoefficientChecks checks = check_estimate(fit, result.row_interval_s, flight);
    estimation::widen(*fit.chosen, checks.scatter, options.significance);
    result.evidence = coefficient_evidence(result.name, checks, fit.comparison, options);
    std::vector<estimation::Evidence> plausible;
    if (!result.per_unit_inertia) plausible = plausibility(given.coefficient, fit.chosen->parameters, flight.subject);
    result.evidence.insert(result.evidence.end(), plausible.begin(), plausible.end());
    for (const FlightEvidence& of_recording : flight.recording)
      if (of_recording.bears_on(given.coefficient)) result.evidence.push_back(of_recording.row);
    result.judgement = estimation::judge(result.evidence);
    const estimation::GroupVerdict reached = estimation::verdict_of(result.judgement);
    if (reached == estimation::GroupVerdict::kIdentified) {
      result.body_sensitivity = sensitivity_to_body(fit, flight);
      widen(*fit.chosen, result.body_sensitivity, options.significance);
      widen(*fit.chosen, doubts_of_air_data(fit, flight, true), options.significance);
      verdict =
          explain(result, *fit.chosen, checks, dominant_constant(*fit.chosen, result.body_sensitivity, flight.subject));
    } else {
      verdict = {reached, objection(result, checks)};
    }
    fit.chosen->parameters = weak_by_collinearity(std::move(fit.chosen->parameters), result.evidence);
    fit.chosen->parameters = estimation::marked(
        estimation::marked(std::move(fit.chosen->parameters), plausible, ParameterStatus::kImplausible), reached);
    if (reached == estimation::GroupVerdict::kIdentified) {
      result.air_data_doubt = doubts_of_air_data(fit, flight, false).rowwise().norm();
      fit.chosen->parameters = weak_by_doubt(std::move(fit.chosen->parameters), result.air_data_doubt);
      result.evidence.push_back(doubt_row(result.name, fit.chosen->parameters, result.air_data_doubt));
    }
    result.identification_fit = checks.identification_fit;
    result.holdout_fit = checks.holdout_fit;
    result.unmodelled_share = checks.unmodelled_share;
    result.contradiction_p = checks.contradiction_p;
    result.residual_autocorrelation = checks.residual_autocorrelation;
  }
  result.verdict = verdict.verdict;
  result.reason = std::move(verdict.reason);
  result.model = std::move(fit.model);
  result.data = std::move(fit.data);
  result.comparison = std::move(fit.comparison);
  result.chosen = std::move(fit.chosen);
  result.error_ratio = fit.error_ratio;
  CoefficientSeries series = series_of(result.model, flight);
  return with_series(std::move(result), std::move(series));
}

/// A given model against the excited segments of the flight.
CoefficientResult evaluate_coefficient(const CoefficientModel& model, const FlightView& flight) {
  CoefficientResult result = describe_coefficient(model, flight);
  if (!result.reason.empty()) return result;
  const std::string& name = result.name;
  const AxisSegments& axis = flight.axis_of_model(model);
  const RegressionData data = coefficient_data(model, flight.signals, axis.excited, flight.subject);
  if (data.rows() < static_cast<Eigen::Index>(10 * model.size())) {
    result.verdict = estimation::GroupVerdict::kNotExcited;
    result.reason = fmt::format("{} cannot be judged: {}", name, axis.text);
    return result;
  }
  result.holdout_fit = fit_on(data, Eigen::Map<const Eigen::VectorXd>(model.values.data(), signed_index(model.size())));
  const double explained = 100.0 * std::max(0.0, result.holdout_fit.r2);
  const double least = flight.options.min_holdout_r2;
  const bool holds = result.holdout_fit.r2 >= least;
  result.verdict = holds ? estimation::GroupVerdict::kIdentified : estimation::GroupVerdict::kRejected;
  result.evidence = {
      {.name = "another flight",
       .about = name,
       .outcome = estimation::passed_or(holds, estimation::Outcome::kFailed),
       .value = result.holdout_fit.r2,
       .limit = least,
       .scale = "R2",
       .text = fmt::format("it explains {:.0f} % of the coefficient's variance in this flight", explained),
       .bears_on = estimation::Purpose::kPrediction}};
  result.judgement = estimation::judge(result.evidence);
  result.reason =
      holds ? fmt::format("{} holds: it explains {:.0f} % of this flight", name, explained)
            : fmt::format(
                  "{} does not hold: it explains {:.0f} % of the coefficient's variance in this flight, less than "
                  "{:.0f} %",
                  name, explained, 100.0 * least);
  CoefficientSeries series = series_of(model, flight);
  return with_series(std::move(result), std::move(series));
}

}  // namespace

std::string unmodelled_text(double error_ratio, double unmodelled_share) {
  const double times = std::sqrt(std::max(0.0, error_ratio));
  if (!(error_ratio > 0.0) || !std::isfinite(times) || !std::isfinite(unmodelled_share)) {
    return "the errors of its regressors leave no signal to judge by how much of its residual is noise of the sensors";
  }
  return fmt::format(
      "{:.0f} % of its variance is neither modelled nor sensor noise (residual {:.1f} times what the sensors leave), "
      "so something that moves the aircraft is not among the regressors and biases them",
      100.0 * unmodelled_share, times);
}

std::vector<CoefficientResult> identify_coefficients(const FlightSignals& signals, const Segments& segments,
                                                     const Subject& subject, const IdentifyOptions& options,
                                                     Progress& progress, std::span<const FlightEvidence> recording) {
  std::vector<CoefficientResult> results;
  const FlightView flight{signals, segments, subject, options, recording};
  progress.stage("identifying coefficients");
  std::size_t done = 0;
  for (const Coefficient c : enumerators<Coefficient, kCoefficients>()) {
    ++done;
    const CoefficientModel* model = subject.model.find(c);
    const auto& some = options.coefficients;
    if (model == nullptr || (!some.empty() && std::find(some.begin(), some.end(), c) == some.end())) continue;
    results.push_back(identify_coefficient(*model, flight));
    if (!progress.update(static_cast<double>(done) / static_cast<double>(kCoefficients))) break;
  }
  return results;
}

std::vector<CoefficientResult> evaluate_estimate(const FlightSignals& signals, const Segments& segments,
                                                 const Subject& subject, const IdentifyOptions& options,
                                                 const estimation::Estimate& estimate) {
  std::vector<CoefficientResult> results;
  const FlightView flight{signals, segments, subject, options, {}};
  for (const Coefficient c : enumerators<Coefficient, kCoefficients>()) {
    const CoefficientModel* structure = subject.model.find(c);
    if (structure == nullptr) continue;
    std::vector<std::string> names;
    for (const Term& term : structure->terms)
      names.push_back(regressed_parameter_name(structure->coefficient, term, subject));
    const CoefficientModel model = estimated_coefficient(*structure, names, estimate);
    if (model.size() > 0) {
      results.push_back(evaluate_coefficient(model, flight));
    } else if (std::ranges::any_of(names, [&](const std::string& n) { return estimate.find(n) != nullptr; })) {
      CoefficientResult result = describe_coefficient(*structure, flight);
      result.reason = fmt::format("{} is not validated: it was rejected where it was identified", result.name);
      results.push_back(std::move(result));
    }
  }
  if (std::ranges::all_of(results,
                          [](const CoefficientResult& r) { return r.model.values.empty() || !r.model.known(); })) {
    throw InputError(estimate.subject, "the estimate holds no usable parameter of the study's model");
  }
  return results;
}

}  // namespace veridyn::aircraft
