#include "veridyn/aircraft/identification/identified_estimate.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "veridyn/aircraft/identification/signals/measured_coefficients.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {

using estimation::ParameterStatus;
using estimation::RegressionEstimate;

std::vector<Coefficient> identified_coefficients(std::span<const CoefficientResult> results) {
  std::vector<Coefficient> found;
  for (const CoefficientResult& result : results) {
    // Per unit inertia nothing can be simulated.
    if (estimation::usable(result.verdict) && !result.per_unit_inertia) found.push_back(result.coefficient);
  }
  return found;
}

Subject identified_subject(const Subject& subject, std::span<const CoefficientResult> results) {
  Subject identified = subject;
  for (auto& coefficient : identified.model.coefficients) {
    if (coefficient) std::fill(coefficient->values.begin(), coefficient->values.end(), kNaN);
  }
  for (const CoefficientResult& result : results) {
    if (estimation::usable(result.verdict) && !result.per_unit_inertia) identified.model.set(result.model);
  }
  return identified;
}

namespace {

/// Covariance of the parameters of two coefficients that one run of output error gave together, as their error bars
/// were widened since; 0 where they are of different runs.
Eigen::MatrixXd shared_run(const CoefficientResult& a, const CoefficientResult& b,
                           std::span<const AxisOutputError> runs) {
  Eigen::MatrixXd cross = Eigen::MatrixXd::Zero(a.chosen->theta.size(), b.chosen->theta.size());
  if (a.axis != b.axis || a.output_error_widening.size() == 0 || b.output_error_widening.size() == 0) return cross;
  const auto run = std::ranges::find(runs, a.axis, &AxisOutputError::axis);
  if (run == runs.end()) return cross;
  const auto place = [&](const std::string& name) {
    return std::ranges::find(run->estimate.parameters, name, &estimation::Parameter::name) -
           run->estimate.parameters.begin();
  };
  for (Eigen::Index i = 0; i < cross.rows(); ++i) {
    const Eigen::Index of_a = place(a.chosen->parameters[i].name);
    for (Eigen::Index j = 0; j < cross.cols(); ++j) {
      const double factor = a.output_error_widening(i) * b.output_error_widening(j);
      if (factor > 0.0) cross(i, j) = factor * run->estimate.covariance(of_a, place(b.chosen->parameters[j].name));
    }
  }
  return cross;
}

}  // namespace

estimation::Estimate make_estimate(const Subject& subject, std::span<const CoefficientResult> results,
                                   std::span<const AxisOutputError> runs) {
  estimation::Estimate estimate;
  estimate.subject = subject.name;
  std::vector<std::string> methods;
  Eigen::Index total = 0;
  const auto listed = [](const CoefficientResult& result) {
    return result.chosen || result.verdict == estimation::GroupVerdict::kNotExcited;
  };
  for (const CoefficientResult& result : results) {
    if (listed(result)) total += static_cast<Eigen::Index>(result.model.size());
  }
  estimate.covariance = Eigen::MatrixXd::Zero(total, total);
  std::vector<std::pair<Eigen::Index, const CoefficientResult*>> shared;
  Eigen::Index at = 0;
  for (const CoefficientResult& result : results) {
    const std::string& name = result.name;
    if (!listed(result)) continue;
    if (!result.chosen) {
      // Nothing was estimated: the parameters are listed all the same, so that a missing one is not read as zero.
      for (std::size_t i = 0; i < result.model.size(); ++i) {
        const Term& term = result.model.terms[i];
        estimate.parameters.push_back({regressed_parameter_name(result.coefficient, term, subject), kNaN, kNaN, kNaN,
                                       kNaN, regressed_parameter_unit(result.coefficient, term, subject),
                                       ParameterStatus::kNotExcited});
        estimate.covariance(at, at) = kNaN;
        ++at;
      }
      continue;
    }
    const RegressionEstimate& chosen = *result.chosen;
    for (const auto& p : chosen.parameters) {
      estimate.parameters.push_back(p);
      if (result.verdict == estimation::GroupVerdict::kNotExcited)
        estimate.parameters.back().status = ParameterStatus::kNotExcited;
    }
    estimate.covariance.block(at, at, chosen.theta.size(), chosen.theta.size()) = chosen.covariance;
    // Coefficients are estimated separately, but share the errors of mass, geometry, inertia and sensors.
    for (const auto& [other, earlier] : shared) {
      Eigen::MatrixXd cross = shared_run(result, *earlier, runs);
      for (const auto errors : {&CoefficientResult::body_sensitivity, &CoefficientResult::sensor_sensitivity}) {
        const Eigen::MatrixXd &G = result.*errors, &of_earlier = earlier->*errors;
        if (G.size() > 0 && of_earlier.size() > 0) cross += G * of_earlier.transpose();
      }
      estimate.covariance.block(at, other, cross.rows(), cross.cols()) = cross;
      estimate.covariance.block(other, at, cross.cols(), cross.rows()) = cross.transpose();
    }
    shared.emplace_back(at, &result);
    at += chosen.theta.size();
    const IntervalParts& parts = result.interval_parts;
    for (Eigen::Index i = 0; i < parts.noise.size(); ++i) {
      estimate.interval_parts[chosen.parameters[i].name] = {{"by_noise", "noise", parts.noise(i)},
                                                            {"by_air_data", "air data", parts.air_data(i)},
                                                            {"by_delays", "delays", parts.delays(i)},
                                                            {"by_body", "mass and geometry", parts.body(i)}};
    }
    estimate.fit[name + ".r2"] = result.identification_fit.r2;
    estimate.fit[name + ".residual_sd"] = chosen.residual_sd;
    estimate.fit[name + ".samples"] = static_cast<double>(chosen.rows);
    estimate.fit[name + ".error_ratio"] = result.error_ratio;
    estimate.fit[name + ".unmodelled_share"] = result.unmodelled_share;
    if (std::ranges::find(methods, result.method) == methods.end()) methods.push_back(result.method);
    if (result.holdout_fit.count > 0) {
      estimate.validation[name] = {result.holdout_fit.mae, result.holdout_fit.rmse, result.holdout_fit.r2,
                                   result.holdout_fit.theil, "1"};
    }
  }
  estimate.method = fmt::format("{}", fmt::join(methods, ", "));
  return estimate;
}

}  // namespace veridyn::aircraft
