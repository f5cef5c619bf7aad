#include "veridyn/aircraft/identification/other_estimators.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/estimation/regression/bootstrap.hpp"
#include "veridyn/estimation/regression/frequency_domain.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Parameter;
using estimation::RegressionEstimate;

using estimation::kBeyondChance;

/// Where a parameter differs between flights, other methods on the same flights know its mean no better than
/// regression.
Parameter with_scatter(Parameter p, const CoefficientResult& result) {
  if (!result.scatter || !result.scatter->found() || !result.chosen) return p;
  const auto& all = result.chosen->parameters;
  const auto found = std::ranges::find(all, p.name, &Parameter::name);
  if (found == all.end()) return p;
  const auto j = static_cast<Eigen::Index>(found - all.begin());
  if (!(result.scatter->sigma(j) > p.sigma)) return p;
  p.sigma = result.scatter->sigma(j);
  estimation::set_interval(p, result.scatter->degrees_of_freedom());
  return p;
}

OtherParameter compared(const CoefficientResult& result, const std::string& method, const Parameter& estimated) {
  const Parameter p = with_scatter(estimated, result);
  OtherParameter row;
  row.coefficient = result.coefficient;
  row.estimate = {method, p};
  const Parameter* chosen = result.chosen ? result.chosen->find(p.name) : nullptr;
  row.normalised_difference = chosen != nullptr ? (p.value - chosen->value) / std::hypot(p.sigma, chosen->sigma) : kNaN;
  if (!std::isfinite(p.sigma)) row.normalised_difference = kNaN;
  return row;
}

/// A sentence naming the parameters whose value by `method` differs from the chosen one by more than the errors allow;
/// empty where there are none.
std::string contradictions(std::span<const OtherParameter> parameters, const std::string& method,
                           const std::string& chosen) {
  std::vector<std::string> names;
  for (const OtherParameter& row : parameters) {
    if (row.estimate.method == method && std::abs(row.normalised_difference) > kBeyondChance)
      names.push_back(fmt::format("{} ({:+.1f} sigma)", row.estimate.parameter.name, row.normalised_difference));
  }
  return names.empty() ? "" : fmt::format("{} contradicts {} in {}", method, chosen, fmt::join(names, ", "));
}

AxisOutputError beside_regression(Axis axis, std::span<const PreparedFlight> flights, const Subject& subject,
                                  std::span<const CoefficientResult> results, const IdentifyOptions& options,
                                  Progress& progress) {
  std::vector<CoefficientModel> models;
  for (const CoefficientResult& r : results)
    if (r.axis == axis && r.chosen && !r.per_unit_inertia) models.push_back(r.model);
  return axis_output_error(axis, flights, RowUse::kIdentification, subject, std::move(models), options, progress);
}

std::vector<OtherParameter> output_error_parameters(const AxisOutputError& run,
                                                    std::span<const CoefficientResult> results) {
  std::vector<OtherParameter> rows;
  if (!run.attempted || !run.estimate.usable()) return rows;
  for (const Parameter& p : run.estimate.parameters) {
    for (const CoefficientResult& r : results) {
      if (r.chosen && r.chosen->find(p.name) != nullptr) rows.push_back(compared(r, "output error", p));
    }
  }
  return rows;
}

/// The regression that a coefficient by output error started from.
std::vector<OtherParameter> started_from(const CoefficientResult& r) {
  std::vector<OtherParameter> rows;
  const RegressionEstimate* regression = r.chosen ? r.comparison.find(r.chosen->method) : nullptr;
  if (regression == nullptr) return rows;
  for (const Parameter& p : regression->parameters)
    rows.push_back(compared(r, std::string(estimation::to_string(regression->method)), p));
  return rows;
}

/// What one method made of one coefficient.
struct MethodOutcome {
  std::vector<OtherParameter> parameters;
  std::string note;
};

MethodOutcome by_frequency_domain(const CoefficientResult& r, const IdentifyOptions& options) {
  const std::string method = "frequency domain";
  estimation::FrequencyOptions o;
  o.low_Hz = options.frequency_low_Hz;
  o.high_Hz = options.frequency_high_Hz;
  o.significance = options.significance;
  const estimation::FrequencyEstimate f = estimation::frequency_equation_error(r.data, r.row_interval_s, o);
  MethodOutcome outcome;
  if (f.estimate.usable()) {
    for (const Parameter& p : f.estimate.parameters) outcome.parameters.push_back(compared(r, method, p));
  }
  outcome.note = fmt::format("{}, {}: {}", method, name_of(r.coefficient), f.estimate.message);
  return outcome;
}

MethodOutcome by_bootstrap(const CoefficientResult& r, const IdentifyOptions& options, Progress& progress) {
  const RegressionEstimate& chosen = *r.chosen;
  estimation::RegressionOptions regression;
  regression.signal_to_noise = options.signal_to_noise;
  estimation::BootstrapOptions o;
  o.replicates = options.bootstrap;
  o.seed = options.seed + static_cast<std::uint64_t>(r.coefficient) + 1;
  const estimation::Bootstrap b =
      estimation::block_bootstrap(r.data, estimation::point_estimator(chosen.method, regression), o, progress);
  const std::string method = fmt::format("bootstrap of {}", estimation::to_string(chosen.method));
  MethodOutcome outcome;
  if (b.usable()) {
    for (std::size_t i = 0; i < chosen.parameters.size(); ++i) {
      Parameter p = chosen.parameters[i];
      p.sigma = b.sigma(i);
      p.low95 = b.low95(i);
      p.high95 = b.high95(i);
      outcome.parameters.push_back(compared(r, method, p));
    }
  }
  outcome.note = fmt::format("{}, {}: {}", method, name_of(r.coefficient), b.message);
  return outcome;
}

}  // namespace

OtherEstimators compare_other_estimators(std::span<const PreparedFlight> flights, const Subject& subject,
                                         const Identification& found, const IdentifyOptions& options,
                                         Progress& progress) {
  const std::vector<CoefficientResult>& results = found.coefficients;
  OtherEstimators others;
  const auto add = [&](std::vector<OtherParameter> parameters, std::string note) {
    std::move(parameters.begin(), parameters.end(), std::back_inserter(others.parameters));
    if (!note.empty()) others.notes.push_back(std::move(note));
  };
  if (options.choose_output_error) {
    others.output_error = found.output_error;
    for (const CoefficientResult& r : results) add(started_from(r), "");
    for (const AxisOutputError& run : others.output_error) others.notes.push_back(run.text);
  } else if (options.output_error) {
    progress.stage("output error");
    for (const Axis axis : {Axis::kLongitudinal, Axis::kLateral}) {
      AxisOutputError run = beside_regression(axis, flights, subject, results, options, progress);
      add(output_error_parameters(run, results), run.text);
      others.output_error.push_back(std::move(run));
    }
  }
  if (options.frequency_high_Hz > 0.0) {
    for (const CoefficientResult& r : results) {
      if (!r.chosen) continue;
      MethodOutcome outcome = by_frequency_domain(r, options);
      add(std::move(outcome.parameters), std::move(outcome.note));
    }
  }
  if (options.bootstrap > 0) {
    progress.stage("bootstrap");
    for (const CoefficientResult& r : results) {
      if (!r.chosen || progress.interrupted()) continue;
      MethodOutcome outcome = by_bootstrap(r, options, progress);
      add(std::move(outcome.parameters), std::move(outcome.note));
    }
  }
  const std::string reference = options.choose_output_error ? "output error" : "regression";
  for (const char* method : {"output error", "frequency domain"}) {
    std::string text = contradictions(others.parameters, method, reference);
    if (!text.empty()) others.notes.push_back(std::move(text));
  }
  return others;
}

}  // namespace veridyn::aircraft
