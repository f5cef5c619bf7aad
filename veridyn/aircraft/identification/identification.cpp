#include "veridyn/aircraft/identification/identification.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/identification/body_error.hpp"
#include "veridyn/aircraft/identification/coefficient_rows.hpp"
#include "veridyn/aircraft/model/estimated_subject.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/estimation/judgement/agreement.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Method;
using estimation::ParameterStatus;
using estimation::RegressionComparison;
using estimation::RegressionData;
using estimation::RegressionEstimate;
using estimation::RegressionOptions;
using internal::complete;
using internal::needed_signals;

/// Factor within which the noise of the sensors is known.
constexpr double kNoiseDoubt = 2.0;

/// Variance of z that neither the model nor the errors of the regressors explain: z'z/N - W_.. of the moment equations
/// (Fuller 1987, sec. 2.2), or NaN where the regressors' errors leave no signal.
double unexplained_variance(const RegressionData& data) {
  const auto n = data.parameters();
  const auto rows = static_cast<double>(data.rows());
  const Eigen::MatrixXd W = data.error_covariance;
  const Eigen::MatrixXd A = data.regressors.transpose() * data.regressors / rows - W.topLeftCorner(n, n);
  const Eigen::VectorXd b = data.regressors.transpose() * data.regressand / rows - W.topRightCorner(n, 1);
  // Columns of unlike size: scaled before the factorisation says whether A is positive definite.
  const Eigen::VectorXd scale = data.regressors.colwise().norm().transpose() / std::sqrt(rows);
  if (!(scale.minCoeff() > 0.0)) return kNaN;
  const Eigen::VectorXd inverse = scale.cwiseInverse();
  const numerics::PivotedCholesky factor(inverse.asDiagonal() * A * inverse.asDiagonal());
  if (!(factor.smallest_pivot() > 1e-12)) return kNaN;
  const Eigen::VectorXd y = factor.solve(Eigen::VectorXd(inverse.asDiagonal() * b));
  return data.regressand.squaredNorm() / rows - b.dot(inverse.asDiagonal() * y);
}

/// The smallest W_zz with which W is still a covariance: what the errors that z shares with the regressors amount to.
double least_response_variance(const Eigen::MatrixXd& W) {
  const auto n = W.rows() - 1;
  const Eigen::VectorXd shared = W.topRightCorner(n, 1);
  return 1.001 * shared.dot(numerics::shortest_least_squares(W.topLeftCorner(n, n), shared));
}

/// Predicted and measured coefficient over rows.
numerics::FitMeasures fit_on(const RegressionData& data, const Eigen::VectorXd& theta) {
  const Eigen::VectorXd model = data.regressors * theta;
  return numerics::fit_measures({data.regressand.data(), static_cast<std::size_t>(data.regressand.size())},
                                {model.data(), static_cast<std::size_t>(model.size())});
}

const RegressionEstimate* choose(const RegressionComparison& comparison, const std::string& method) {
  if (method == "auto") {
    if (const RegressionEstimate* best = comparison.best()) return best;
    // What it would have been, so that the refusal can be seen beside it.
    for (const Method fallback : {Method::kPcaGtls, Method::kGtls, Method::kOls}) {
      const RegressionEstimate* estimate = comparison.find(fallback);
      if (estimate != nullptr && estimate->usable()) return estimate;
    }
    return nullptr;
  }
  for (const RegressionEstimate& estimate : comparison.estimates) {
    if (estimation::to_string(estimate.method) == method && estimate.usable()) return &estimate;
  }
  return nullptr;
}

/// p of the hypothesis that two independent estimates are of the same parameters.
double contradiction_p(const RegressionEstimate& a, const RegressionEstimate& b) {
  return estimation::agreement_p(a.theta - b.theta, a.covariance + b.covariance);
}

/// The way of one coefficient from rows to verdict. A view of what it was made from.
class CoefficientIdentification {
 public:
  CoefficientIdentification(const FlightSignals& signals, const Segments& segments, const Subject& subject,
                            const IdentifyOptions& options)
      : signals_(&signals), segments_(&segments), subject_(&subject), options_(&options) {}

  CoefficientResult run(const CoefficientModel& structure) {
    CoefficientResult result = begin(structure);
    if (!result.reason.empty()) return result;
    if (options_->structure != "given") choose_structure(result);
    estimate(result);
    if (result.chosen && options_->refit_significant) refit(result);
    judge(result);
    series(result);
    return result;
  }

  /// A given estimate instead of an own one.
  CoefficientResult evaluate(const CoefficientModel& model) {
    CoefficientResult result = begin(model);
    if (!result.reason.empty()) return result;
    const std::string& name = result.name;
    const AxisSegments& axis = segments_->of(result.axis);
    const RegressionData data = coefficient_data(model, *signals_, axis.excited, *subject_);
    if (data.rows() < static_cast<Eigen::Index>(10 * model.size())) {
      result.verdict = CoefficientVerdict::kNotExcited;
      result.reason = fmt::format("{} cannot be judged: {}", name, axis.text);
      return result;
    }
    const Eigen::VectorXd theta =
        Eigen::Map<const Eigen::VectorXd>(model.values.data(), static_cast<Eigen::Index>(model.size()));
    result.holdout_fit = fit_on(data, theta);
    const double explained = 100.0 * std::max(0.0, result.holdout_fit.r2);
    const bool holds = result.holdout_fit.r2 >= options_->min_holdout_r2;
    result.verdict = holds ? CoefficientVerdict::kIdentified : CoefficientVerdict::kRejected;
    result.reason =
        holds ? fmt::format("{} holds: it explains {:.0f} % of this flight", name, explained)
              : fmt::format(
                    "{} does not hold: it explains {:.0f} % of the coefficient's variance in this flight, less than "
                    "{:.0f} %",
                    name, explained, 100.0 * options_->min_holdout_r2);
    series(result);
    return result;
  }

 private:
  CoefficientResult begin(const CoefficientModel& model) const {
    CoefficientResult result;
    result.coefficient = model.coefficient;
    result.name = regressed_name(model.coefficient, *subject_);
    result.per_unit_inertia = per_unit_inertia(model.coefficient, *subject_);
    result.axis = axis_of(model.coefficient);
    result.model = model;
    result.row_interval_s = signals_->grid.step * static_cast<double>(signals_->stride);
    result.reason = identification_obstacle(model, *signals_, *subject_);
    return result;
  }

  RegressionOptions regression_options() const {
    RegressionOptions options;
    options.significance = options_->significance;
    options.signal_to_noise = options_->signal_to_noise;
    return options;
  }

  /// The regressors' errors are known from their sensors; the error of z is whatever the data show, be it less than the
  /// sensors were assumed to leave (then a larger W_zz would hold back the correction of the regressors) or more
  /// (equation error). Returns that variance over what the sensors explain.
  static double assign_equation_error(RegressionData& data) {
    const double unexplained = unexplained_variance(data);
    const auto n = data.parameters();
    const double by_sensors = data.error_covariance(n, n);
    if (unexplained > least_response_variance(data.error_covariance)) data.error_covariance(n, n) = unexplained;
    return unexplained / by_sensors;
  }

  /// What is not known of mass, geometry and inertia goes into the error bars; returns the constant that makes up most.
  std::string widen_by_body_errors(CoefficientResult& result) const {
    const auto again = [&](const Subject& changed) {
      RegressionData data =
          coefficient_data(result.model, *signals_, segments_->of(result.axis).identification, changed);
      static_cast<void>(assign_equation_error(data));
      const RegressionEstimate estimate = estimation::estimate(data, result.chosen->method, regression_options());
      return estimate.usable() ? estimate.theta : Eigen::VectorXd();
    };
    result.body_sensitivity = body_sensitivity(*subject_, result.chosen->theta.size(), again);
    widen(*result.chosen, result.body_sensitivity, options_->significance);
    return dominant_constant(*result.chosen, result.body_sensitivity, *subject_);
  }

  void estimate(CoefficientResult& result) const {
    const AxisSegments& axis = segments_->of(result.axis);
    result.data = coefficient_data(result.model, *signals_, axis.identification, *subject_);
    const auto minimum = static_cast<Eigen::Index>(10 * result.model.size());
    if (result.data.rows() < minimum) {
      result.verdict = CoefficientVerdict::kNotExcited;
      result.reason = axis.excited.empty() ? fmt::format("{} is not excited: {}", result.name, axis.text)
                                           : fmt::format("{} has only {} usable samples on its segments, {} are needed",
                                                         result.name, result.data.rows(), minimum);
      return;
    }
    result.error_ratio = assign_equation_error(result.data);
    result.comparison = estimation::compare(result.data, regression_options());
    if (const RegressionEstimate* chosen = choose(result.comparison, options_->method)) {
      result.chosen = *chosen;
      for (std::size_t i = 0; i < result.model.size(); ++i)
        result.model.values[i] = chosen->theta(static_cast<Eigen::Index>(i));
    }
  }

  /// The terms of the model chosen among the candidates, by least squares on the identification rows.
  void choose_structure(CoefficientResult& result) const {
    CoefficientModel all{result.coefficient, options_->candidates[static_cast<std::size_t>(result.coefficient)], {}};
    if (all.terms.empty()) all.terms = default_candidates(result.model);
    // What the log does not have cannot be chosen.
    std::erase_if(all.terms, [&](const Term& term) {
      const CoefficientModel single{result.coefficient, {term}, {kUnknown}};
      return !identification_obstacle(single, *signals_, *subject_).empty();
    });
    all.values.assign(all.terms.size(), kUnknown);
    const RegressionData data = coefficient_data(all, *signals_, segments_->of(result.axis).identification, *subject_);
    if (all.terms.empty() || data.rows() < static_cast<Eigen::Index>(10 * all.size())) return;
    estimation::StructureOptions search;
    search.method = options_->structure == "stepwise" ? estimation::StructureMethod::kStepwise
                                                      : estimation::StructureMethod::kOrthogonal;
    search.significance = options_->significance;
    result.structure = estimation::search_structure(data, search);
    if (result.structure->selected.empty()) return;
    result.model.terms.clear();
    for (const Eigen::Index j : result.structure->selected)
      result.model.terms.push_back(all.terms[static_cast<std::size_t>(j)]);
    result.model.values.assign(result.model.terms.size(), kUnknown);
  }

  /// Once more with the significant parameters only, the constant always kept.
  void refit(CoefficientResult& result) const {
    CoefficientModel kept{result.coefficient, {}, {}};
    for (std::size_t i = 0; i < result.model.size(); ++i) {
      const bool significant = result.chosen->parameters[i].status == ParameterStatus::kIdentified;
      if (!significant && !result.model.terms[i].constant()) continue;
      kept.terms.push_back(result.model.terms[i]);
      kept.values.push_back(kUnknown);
    }
    if (kept.size() == result.model.size() || kept.size() == 0) return;
    result.model = kept;
    result.chosen.reset();
    estimate(result);
  }

  void judge(CoefficientResult& result) const {
    if (result.verdict == CoefficientVerdict::kNotExcited) return;
    const std::string& name = result.name;
    const auto reject = [&](std::string reason) {
      result.verdict = CoefficientVerdict::kRejected;
      result.reason = std::move(reason);
      if (result.chosen) estimation::reject(*result.chosen);
    };
    if (!result.chosen) return reject(fmt::format("{}: {}", name, result.comparison.reason));
    const RegressionEstimate& chosen = *result.chosen;
    result.identification_fit = fit_on(result.data, chosen.theta);
    // What sensors leave is trusted within a factor of two in standard deviation.
    const double beyond_sensors = std::max(0.0, 1.0 - kNoiseDoubt * kNoiseDoubt / result.error_ratio);
    result.unmodelled_share = (1.0 - result.identification_fit.r2) * beyond_sensors;
    residual_diagnostics(result);

    const AxisSegments& axis = segments_->of(result.axis);
    RegressionData unseen = coefficient_data(result.model, *signals_, axis.holdout, *subject_);
    const bool has_holdout = unseen.rows() >= static_cast<Eigen::Index>(10 * result.model.size());
    if (has_holdout) {
      result.holdout_fit = fit_on(unseen, chosen.theta);
      const auto n = unseen.parameters();
      unseen.error_covariance(n, n) = result.data.error_covariance(n, n);
      const RegressionEstimate again = estimation::estimate(unseen, chosen.method, regression_options());
      if (again.usable()) result.contradiction_p = contradiction_p(chosen, again);
    }
    if (options_->method == "auto" && !result.comparison.recommends) {
      return reject(fmt::format("{} is rejected: {}", name, result.comparison.reason));
    }
    if (!(result.unmodelled_share <= options_->max_unmodelled)) {
      return reject(fmt::format("{} is rejected: {}", name, unmodelled_text(result)));
    }
    if (has_holdout && !(result.holdout_fit.r2 >= options_->min_holdout_r2)) {
      return reject(fmt::format(
          "{} is rejected: it explains {:.0f} % of the coefficient's variance on the hold-out, less than {:.0f} %",
          name, 100.0 * std::max(0.0, result.holdout_fit.r2), 100.0 * options_->min_holdout_r2));
    }
    if (has_holdout && !(result.contradiction_p >= options_->contradiction_level)) {
      return reject(fmt::format(
          "{} is rejected: estimates from two parts of the flight contradict each other beyond their error bars "
          "(p = {:.1e})",
          name, result.contradiction_p));
    }
    const std::string dominant = widen_by_body_errors(result);
    const auto is = [&](ParameterStatus status) {
      std::vector<std::string> names;
      for (const auto& p : chosen.parameters) {
        if (p.status == status) names.push_back(p.name);
      }
      return names;
    };
    const std::vector<std::string> identified = is(ParameterStatus::kIdentified);
    const std::vector<std::string> unexcited = is(ParameterStatus::kNotExcited);
    const std::vector<std::string> insignificant = is(ParameterStatus::kInsignificant);
    if (identified.empty() && !unexcited.empty()) {
      result.verdict = CoefficientVerdict::kNotExcited;
      result.reason = fmt::format("{} is not excited: {}", name, chosen.message);
      return;
    }
    result.verdict = CoefficientVerdict::kIdentified;
    result.reason = has_holdout ? fmt::format("{} is identified by {}: it explains {:.0f} % of the hold-out", name,
                                              estimation::to_string(chosen.method), 100.0 * result.holdout_fit.r2)
                                : fmt::format("{} is identified by {}, but there was no hold-out to validate it on",
                                              name, estimation::to_string(chosen.method));
    if (!dominant.empty()) result.reason += fmt::format("; its error bars are mostly those of {}", dominant);
    if (result.per_unit_inertia)
      result.reason += "; per unit inertia, which is not given (inertial coupling of a flat body assumed)";
    if (!insignificant.empty())
      result.reason += fmt::format("; not distinguishable from zero: {}", fmt::join(insignificant, ", "));
    if (!unexcited.empty()) result.reason += fmt::format("; not excited: {}", fmt::join(unexcited, ", "));
  }

  void residual_diagnostics(CoefficientResult& result) const {
    const Eigen::VectorXd residual = result.data.regressand - result.data.regressors * result.chosen->theta;
    const auto lags = static_cast<std::size_t>(std::clamp(3.0 / result.row_interval_s, 10.0, 200.0));
    result.residual_autocorrelation = numerics::autocorrelation(
        {residual.data(), static_cast<std::size_t>(residual.size())}, lags, result.data.segment);
  }

  void series(CoefficientResult& result) const {
    const std::vector<FlightSignal> needed = needed_signals(result.model);
    const bool estimated = result.model.known();
    for (const TimeSpan& span : segments_->airborne) {
      const auto [begin, end] = signals_->indices(span);
      for (std::size_t k = begin; k < end; k += signals_->stride) {
        const FlightSample<double> sample = signals_->sample(k);
        result.time.push_back(signals_->grid.at(k));
        if (!complete(sample, needed)) {
          result.measured.push_back(kNaN);
          result.modelled.push_back(kNaN);
          continue;
        }
        const double torque = signals_->torque.empty() ? 0.0 : signals_->torque[k];
        const double rho = signals_->air_density[k];
        result.measured.push_back(select(regressed_coefficients(sample, *subject_, rho, torque), result.coefficient));
        result.modelled.push_back(estimated ? result.model.linear(aero_variables(sample, *subject_, rho)) : kNaN);
      }
    }
  }

  const FlightSignals* signals_;
  const Segments* segments_;
  const Subject* subject_;
  const IdentifyOptions* options_;
};

}  // namespace

std::string unmodelled_text(const CoefficientResult& result) {
  const double times = std::sqrt(std::max(0.0, result.error_ratio));
  if (!(result.error_ratio > 0.0) || !std::isfinite(times) || !std::isfinite(result.unmodelled_share)) {
    return "the errors of its regressors leave no signal to judge by how much of its residual is noise of the sensors";
  }
  return fmt::format(
      "{:.0f} % of its variance is neither modelled nor sensor noise (residual {:.1f} times what the sensors leave), "
      "so "
      "something that moves the aircraft is not among the regressors and biases them",
      100.0 * result.unmodelled_share, times);
}

std::vector<CoefficientResult> identify_coefficients(const FlightSignals& signals, const Segments& segments,
                                                     const Subject& subject, const IdentifyOptions& options,
                                                     Progress& progress) {
  std::vector<CoefficientResult> results;
  CoefficientIdentification identification(signals, segments, subject, options);
  progress.stage("identifying coefficients");
  for (std::size_t i = 0; i < kCoefficients; ++i) {
    const auto c = static_cast<Coefficient>(i);
    const CoefficientModel* model = subject.model.find(c);
    const auto& wanted = options.coefficients;
    if (model == nullptr || (!wanted.empty() && std::find(wanted.begin(), wanted.end(), c) == wanted.end())) continue;
    results.push_back(identification.run(*model));
    if (!progress.update(static_cast<double>(i + 1) / static_cast<double>(kCoefficients))) break;
  }
  return results;
}

std::vector<CoefficientResult> evaluate_estimate(const FlightSignals& signals, const Segments& segments,
                                                 const Subject& subject, const IdentifyOptions& options,
                                                 const estimation::Estimate& estimate) {
  std::vector<CoefficientResult> results;
  CoefficientIdentification identification(signals, segments, subject, options);
  for (std::size_t i = 0; i < kCoefficients; ++i) {
    const CoefficientModel* structure = subject.model.find(static_cast<Coefficient>(i));
    if (structure == nullptr) continue;
    std::vector<std::string> names;
    for (const Term& term : structure->terms)
      names.push_back(regressed_parameter_name(structure->coefficient, term, subject));
    const CoefficientModel model = estimated_coefficient(*structure, names, estimate);
    if (model.size() > 0) results.push_back(identification.evaluate(model));
  }
  if (results.empty()) {
    throw InputError(estimate.subject, "the estimate holds no usable parameter of the study's model");
  }
  return results;
}

}  // namespace veridyn::aircraft
