#include "veridyn/aircraft/identification/identification.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/identification/evidence/coefficient_evidence.hpp"
#include "veridyn/aircraft/identification/fit/body_error.hpp"
#include "veridyn/aircraft/identification/fit/coefficient_description.hpp"
#include "veridyn/aircraft/identification/fit/coefficient_fit.hpp"
#include "veridyn/aircraft/identification/fit/error_variance.hpp"
#include "veridyn/aircraft/identification/fit/model_error.hpp"
#include "veridyn/aircraft/identification/fit/sensor_width.hpp"
#include "veridyn/aircraft/identification/output_error/chosen_output_error.hpp"
#include "veridyn/aircraft/identification/rows/coefficient_rows.hpp"
#include "veridyn/aircraft/identification/rows/flight_rows.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/agreement.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Method;
using estimation::ParameterStatus;
using estimation::RegressionComparison;
using estimation::RegressionData;
using estimation::RegressionEstimate;
using estimation::RegressionOptions;
using estimation::StructureMethod;
using internal::ChosenOutputError;
using internal::CoefficientFit;
using internal::fit_coefficient;
using internal::FlightView;
using internal::with_series;

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
    return !identification_obstacle(single, flight.flights, flight.subject).empty();
  });
  all.values.assign(all.terms.size(), kNaN);
  const RegressionData data = flight.rows(all, RowUse::kIdentification).data;
  if (all.terms.empty() || data.rows() < static_cast<Eigen::Index>(10 * all.size())) return {given, std::nullopt};
  estimation::StructureOptions options;
  options.method = method;
  options.significance = flight.options.significance;
  estimation::StructureSearch search = estimation::search_structure(data, options);
  if (search.selected.empty()) return {given, std::move(search)};
  CoefficientModel chosen{c, {}, {}};
  for (const Eigen::Index j : search.selected) chosen.terms.push_back(all.terms[j]);
  chosen.values.assign(chosen.terms.size(), kNaN);
  return {std::move(chosen), std::move(search)};
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

/// See body_sensitivity: each of the aircraft's constants is changed and the parameters estimated again.
Eigen::MatrixXd sensitivity_to_body(const CoefficientFit& fit, const FlightView& flight) {
  return body_sensitivity(flight.subject, fit.chosen->theta.size(), [&](const Subject& changed) {
    RegressionData data = coefficient_rows(fit.model, flight.flights, RowUse::kIdentification, changed).data;
    const auto n = data.parameters();
    data.error_covariance(n, n) = equation_error(data).variance;
    const RegressionEstimate estimate = estimation::estimate(data, fit.chosen->method, flight.regression_options());
    return estimate.usable() ? estimate.theta : Eigen::VectorXd();
  });
}

/// See sensor_sensitivity: of the errors of each flight. A sensor is the same in all flights, and so is its error: it
/// does not average out over them, nor show in their scatter.
Eigen::MatrixXd sensitivity_to_sensors(const CoefficientFit& fit, const FlightView& view) {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(fit.of_rows.size(), kSensorErrors);
  for (std::size_t i = 0; i < view.flights.size(); ++i) {
    const PreparedFlight& flight = view.flights[i];
    if (fit.rows.rows_of(i) == 0) continue;
    columns += sensor_sensitivity(
        flight.signals, flight.budget, fit.model.coefficient, fit.of_rows, [&](const FlightSignals& changed) {
          const bool same = changed.air_rates.error_of_roll() == flight.signals.air_rates.error_of_roll();
          RegressionData data = coefficient_rows(fit.model, view.flights, RowUse::kIdentification, view.subject,
                                                 &flight, &changed, same ? &fit.rows.data.error_covariance : nullptr)
                                    .data;
          const auto n = data.parameters();
          data.error_covariance(n, n) = equation_error(data).variance;
          const RegressionEstimate estimate = estimation::estimate(data, fit.chosen->method, view.regression_options());
          return estimate.usable() ? estimate.theta : Eigen::VectorXd();
        });
  }
  return columns;
}

/// Widens the intervals by what is not known of the aircraft and its sensors.
void widen_by_budget(CoefficientResult& result, CoefficientFit& fit, const FlightView& view) {
  const auto& parameters = fit.chosen->parameters;
  Eigen::VectorXd noise(static_cast<Eigen::Index>(parameters.size()));
  for (Eigen::Index i = 0; i < noise.size(); ++i) noise(i) = parameters[static_cast<std::size_t>(i)].sigma;
  result.body_sensitivity = sensitivity_to_body(fit, view);
  result.sensor_sensitivity = sensitivity_to_sensors(fit, view);
  result.interval_parts = interval_parts(noise, result.sensor_sensitivity, result.body_sensitivity);
  widen(*fit.chosen, result.body_sensitivity, view.options.significance);
  widen(*fit.chosen, result.sensor_sensitivity, view.options.significance);
}

/// A verdict and the sentence that explains it.
struct ExplainedVerdict {
  estimation::GroupVerdict verdict;
  std::string reason;
};

/// Why the parameters of an estimate are no physical constants.
std::string objection(const CoefficientResult& judged, const CoefficientChecks& checks) {
  if (estimation::verdict_of(judged.judgement) == estimation::GroupVerdict::kEffective)
    return fmt::format("{} predicts {:.0f} % of the hold-out, but its values are no physical constants", judged.name,
                       100.0 * std::max(0.0, checks.holdout_fit.r2));
  const std::vector<std::string>& why = judged.judgement.parameters.decided_by;
  return fmt::format("{} is rejected: {}", judged.name,
                     why.empty() ? "its parameters could not be judged" : why.front());
}

/// Of an estimate that may be used. `method` gave it, `dominant` is the constant of the aircraft that makes up most of
/// its error bars.
ExplainedVerdict explain(const CoefficientResult& described, const RegressionEstimate& chosen,
                         const CoefficientChecks& checks, const std::string& method, const std::string& dominant) {
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
  std::string reason =
      checks.has_holdout
          ? fmt::format("{} is identified by {}: it explains {:.0f} % of the hold-out", name, method,
                        100.0 * std::max(0.0, checks.holdout_fit.r2))
          : fmt::format("{} is identified by {}, but there was no hold-out to validate it on", name, method);
  if (!dominant.empty()) reason += fmt::format("; its error bars are mostly those of {}", dominant);
  if (described.per_unit_inertia)
    reason += "; per unit inertia, which is not given (inertial coupling of a flat body assumed)";
  if (!insignificant.empty())
    reason += fmt::format("; not distinguishable from zero: {}", fmt::join(insignificant, ", "));
  if (!unexcited.empty()) reason += fmt::format("; not excited: {}", fmt::join(unexcited, ", "));
  // Why is said by the rows, which stand above and, all of them, in the report.
  if (described.judgement.parameters.grade == estimation::Grade::kWithCare) reason += "; with care";
  return {estimation::GroupVerdict::kIdentified, std::move(reason)};
}

ExplainedVerdict not_excited(const std::string& name, const CoefficientFit& fit, const FlightView& flight, Axis axis) {
  return {estimation::GroupVerdict::kNotExcited,
          any_excited(flight.flights, axis)
              ? fmt::format("{} has only {} usable samples on its segments, {} are needed", name, fit.rows.data.rows(),
                            10 * fit.model.size())
              : fmt::format("{} is not excited: {}", name, segments_text(flight.flights, axis))};
}

/// The parameters of each flight by itself, of those that determine them.
std::vector<FlightEstimate> flight_estimates(const internal::FlightFits& each,
                                             std::span<const PreparedFlight> flights) {
  std::vector<FlightEstimate> estimates;
  for (std::size_t i = 0; i < flights.size(); ++i)
    if (each.fits[i].chosen) estimates.push_back({flights[i].name, each.fits[i].chosen->parameters});
  return estimates;
}

/// A coefficient's terms and regressions, before they are judged.
struct FittedCoefficient {
  CoefficientResult result;  ///< with a reason where there is nothing to fit
  CoefficientFit fit;
};

FittedCoefficient fit_terms(const CoefficientModel& given, const FlightView& flight) {
  const IdentifyOptions& options = flight.options;
  CoefficientResult result = internal::described(given, flight.flights, flight.subject);
  if (!result.reason.empty()) return {std::move(result), {}};
  ChosenTerms terms =
      options.structure ? choose_terms(given, *options.structure, flight) : ChosenTerms{given, std::nullopt};
  result.structure = std::move(terms.search);
  CoefficientFit fit = fit_coefficient(std::move(terms.model), flight);
  if (fit.chosen && options.refit_significant) {
    CoefficientModel kept = significant_terms(fit.model, *fit.chosen);
    if (kept.size() > 0 && kept.size() < fit.model.size()) fit = fit_coefficient(std::move(kept), flight);
  }
  return {std::move(result), std::move(fit)};
}

/// Checks and verdict of a fitted coefficient, or of what output error made of it.
CoefficientResult judged(CoefficientResult result, CoefficientFit fit, const FlightView& flight,
                         const ChosenOutputError* flown) {
  const IdentifyOptions& options = flight.options;
  if (!result.reason.empty()) return result;
  std::optional<internal::FlightFits> each;
  if (fit.chosen && flight.flights.size() > 1) each = internal::fit_each_flight(fit, flight);
  if (flown != nullptr) internal::take_output_error(fit, *flown, each ? &each->scatter : nullptr, flight);

  ExplainedVerdict verdict{estimation::GroupVerdict::kRejected,
                           fmt::format("{}: {}", result.name, fit.comparison.reason)};
  if (!fit.enough_rows) verdict = not_excited(result.name, fit, flight, result.axis);
  if (fit.chosen) {
    result.method = fit.by_output_error ? "output error" : estimation::to_string(fit.chosen->method);
    const CoefficientChecks checks = internal::check_fit(fit, result.row_interval_s, each ? &*each : nullptr, flight);
    const bool scatters = each && each->scatter.found();
    if (!scatters) {
      estimation::widen(*fit.chosen, checks.scatter, options.significance);
      widen(*fit.chosen, model_error(fit.rows.data, fit.unmodelled_share), options.significance);
    }
    if (fit.by_output_error) result.output_error_widening = internal::widening_of(fit, *flown);
    widen_by_budget(result, fit, flight);
    result.evidence = coefficient_evidence(result.name, checks, fit.comparison, options);
    if (each) {
      result.evidence.push_back(scatter_row(result.name, each->scatter, *fit.chosen));
      result.scatter = each->scatter;
      result.flight_estimates = flight_estimates(*each, flight.flights);
    }
    std::vector<estimation::Evidence> plausible;
    if (!result.per_unit_inertia) plausible = plausibility(result.coefficient, fit.chosen->parameters, flight.subject);
    result.evidence.insert(result.evidence.end(), plausible.begin(), plausible.end());
    for (const PreparedFlight& one : flight.flights) {
      for (const estimation::Evidence& of_recording : one.recording_evidence)
        if (affects(of_recording, result.coefficient)) result.evidence.push_back(of_recording);
    }
    result.judgement = estimation::judge(result.evidence);
    const estimation::GroupVerdict reached = estimation::verdict_of(result.judgement);
    if (reached == estimation::GroupVerdict::kIdentified) {
      verdict = explain(result, *fit.chosen, checks, result.method,
                        dominant_constant(*fit.chosen, result.body_sensitivity, flight.subject));
    } else {
      verdict = {reached, objection(result, checks)};
    }
    fit.chosen->parameters = estimation::marked(
        estimation::marked(std::move(fit.chosen->parameters), plausible, ParameterStatus::kImplausible), reached);
    if (reached == estimation::GroupVerdict::kIdentified)
      result.evidence.push_back(sensor_share_row(result.name, fit.chosen->parameters, result.interval_parts));
    result.identification_fit = checks.identification_fit;
    result.holdout_fit = checks.holdout_fit;
    result.flight_fits = checks.flight_fits;
    result.unmodelled_share = checks.unmodelled_share;
    result.contradiction_p = checks.contradiction_p;
    result.residual_autocorrelation = checks.residual_autocorrelation;
  }
  result.verdict = verdict.verdict;
  result.reason = std::move(verdict.reason);
  result.model = std::move(fit.model);
  result.data = std::move(fit.rows.data);
  result.comparison = std::move(fit.comparison);
  result.chosen = std::move(fit.chosen);
  result.error_ratio = fit.error_ratio;
  return with_series(std::move(result), flight.flights, flight.subject);
}

/// Output error from where the regressions ended.
ChosenOutputError fly_axes(std::span<const FittedCoefficient> fitted, const FlightView& flight, Progress& progress) {
  std::vector<CoefficientModel> models;
  for (const auto& [result, fit] : fitted)
    if (fit.chosen && !result.per_unit_inertia) models.push_back(fit.model);
  return internal::fly_axes(models, flight, progress);
}

}  // namespace

Identification identify_coefficients(std::span<const PreparedFlight> flights, const Subject& subject,
                                     const IdentifyOptions& options, Progress& progress) {
  const FlightView flight{flights, subject, options};
  progress.stage("identifying coefficients");
  std::vector<const CoefficientModel*> models;
  for (const Coefficient c : enumerators<Coefficient, kCoefficients>()) {
    const CoefficientModel* model = subject.model.find(c);
    const auto& some = options.coefficients;
    if (model != nullptr && (some.empty() || std::ranges::find(some, c) != some.end())) models.push_back(model);
  }
  const double steps = 2.0 * static_cast<double>(models.size());
  std::vector<FittedCoefficient> fitted(models.size());
  const auto fit = [&](std::size_t i) { fitted[i] = fit_terms(*models[i], flight); };
  const auto fitting = [&](std::size_t done) { return progress.update(static_cast<double>(done) / steps); };
  if (!numerics::parallel_for(models.size(), progress.threads(), fit, fitting)) return {};
  std::optional<ChosenOutputError> flown;
  if (options.choose_output_error) {
    progress.stage("output error");
    flown = fly_axes(fitted, flight, progress);
  }
  Identification found;
  found.coefficients.resize(models.size());
  const auto judge = [&](std::size_t i) {
    found.coefficients[i] =
        judged(std::move(fitted[i].result), std::move(fitted[i].fit), flight, flown ? &*flown : nullptr);
  };
  const auto judging = [&](std::size_t done) { return progress.update(0.5 + static_cast<double>(done) / steps); };
  if (!numerics::parallel_for(models.size(), progress.threads(), judge, judging)) return {};
  if (flown) found.output_error = std::move(flown->identification);
  return found;
}

std::vector<CoefficientResult> not_identified(const Subject& subject, const IdentifyOptions& options,
                                              const Contradiction& contradiction,
                                              std::span<const estimation::Evidence> evidence) {
  std::vector<CoefficientResult> results;
  for (const Coefficient coefficient : enumerators<Coefficient, kCoefficients>()) {
    const CoefficientModel* model = subject.model.find(coefficient);
    const auto& some = options.coefficients;
    if (model == nullptr || (!some.empty() && std::ranges::find(some, coefficient) == some.end())) continue;
    CoefficientResult result;
    result.coefficient = coefficient;
    result.name = std::string(name_of(coefficient));
    result.axis = axis_of(coefficient);
    result.model = *model;
    result.reason = fmt::format("{} is not identified: the motion is not known, {} contradicts {}", result.name,
                                contradiction.channel, contradiction.against);
    for (const estimation::Evidence& row : evidence)
      if (affects(row, coefficient)) result.evidence.push_back(row);
    result.judgement = estimation::judge(result.evidence);
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace veridyn::aircraft
