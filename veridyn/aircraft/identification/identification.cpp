#include "veridyn/aircraft/identification/identification.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "veridyn/aircraft/identification/body_error.hpp"
#include "veridyn/aircraft/model/estimated_subject.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
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

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
/// Rows on which the error covariance is averaged: the Jacobian varies slowly.
constexpr std::size_t kCovarianceRows = 2000;
/// Factor within which the noise of the sensors is known.
constexpr double kNoiseDoubt = 2.0;

std::vector<FlightSignal> needed_signals(const CoefficientModel& model) {
  std::vector<FlightSignal> needed{FlightSignal::kAirspeed};
  const auto uses = [&](AeroVariable v) {
    return std::any_of(model.terms.begin(), model.terms.end(), [&](const Term& t) { return t.uses(v); });
  };
  if (uses(AeroVariable::kAlpha)) needed.push_back(FlightSignal::kAlpha);
  if (uses(AeroVariable::kBeta)) needed.push_back(FlightSignal::kBeta);
  if (uses(AeroVariable::kDe)) needed.push_back(FlightSignal::kElevator);
  if (uses(AeroVariable::kDa)) needed.push_back(FlightSignal::kAileron);
  if (uses(AeroVariable::kDr)) needed.push_back(FlightSignal::kRudder);
  if (uses(AeroVariable::kCT)) needed.push_back(FlightSignal::kThrust);
  if (model.coefficient == Coefficient::kCL || model.coefficient == Coefficient::kCD)
    needed.push_back(FlightSignal::kAlpha);
  return needed;
}

bool complete(const FlightSample<double>& sample, const std::vector<FlightSignal>& needed) {
  return std::all_of(needed.begin(), needed.end(), [&](FlightSignal s) { return std::isfinite(sample[s]); });
}

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
  const Eigen::LDLT<Eigen::MatrixXd> factor(inverse.asDiagonal() * A * inverse.asDiagonal());
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 1e-12)) return kNaN;
  const Eigen::VectorXd y = factor.solve(inverse.asDiagonal() * b);
  return data.regressand.squaredNorm() / rows - b.dot(inverse.asDiagonal() * y);
}

/// The smallest W_zz with which W is still a covariance: what the errors that z shares with the regressors amount to.
double least_response_variance(const Eigen::MatrixXd& W) {
  const auto n = W.rows() - 1;
  const Eigen::VectorXd shared = W.topRightCorner(n, 1);
  return 1.001 * shared.dot(W.topLeftCorner(n, n).completeOrthogonalDecomposition().solve(shared));
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

class CoefficientIdentification {
 public:
  CoefficientIdentification(const FlightSignals& signals, const Segments& segments, const Subject& subject,
                            const IdentifyOptions& options)
      : signals_(signals), segments_(segments), subject_(subject), options_(options) {}

  CoefficientResult run(const CoefficientModel& structure) {
    CoefficientResult result = begin(structure);
    if (!result.reason.empty()) return result;
    if (options_.structure != "given") choose_structure(result);
    estimate(result);
    if (result.chosen && options_.refit_significant) refit(result);
    judge(result);
    series(result);
    return result;
  }

  /// A given estimate instead of an own one.
  CoefficientResult evaluate(const CoefficientModel& model) {
    CoefficientResult result = begin(model);
    if (!result.reason.empty()) return result;
    const std::string& name = result.name;
    const AxisSegments& axis = segments_.of(result.axis);
    const RegressionData data = coefficient_data(model, signals_, axis.excited, subject_);
    if (data.rows() < static_cast<Eigen::Index>(10 * model.size())) {
      result.verdict = CoefficientVerdict::kNotExcited;
      result.reason = fmt::format("{} cannot be judged: {}", name, axis.text);
      return result;
    }
    const Eigen::VectorXd theta =
        Eigen::Map<const Eigen::VectorXd>(model.values.data(), static_cast<Eigen::Index>(model.size()));
    result.holdout_fit = fit_on(data, theta);
    const double explained = 100.0 * std::max(0.0, result.holdout_fit.r2);
    const bool holds = result.holdout_fit.r2 >= options_.min_holdout_r2;
    result.verdict = holds ? CoefficientVerdict::kIdentified : CoefficientVerdict::kRejected;
    result.reason =
        holds ? fmt::format("{} holds: it explains {:.0f} % of this flight", name, explained)
              : fmt::format(
                    "{} does not hold: it explains {:.0f} % of the coefficient's variance in this flight, less than "
                    "{:.0f} %",
                    name, explained, 100.0 * options_.min_holdout_r2);
    series(result);
    return result;
  }

 private:
  CoefficientResult begin(const CoefficientModel& model) const {
    CoefficientResult result;
    result.coefficient = model.coefficient;
    result.name = regressed_name(model.coefficient, subject_);
    result.per_unit_inertia = per_unit_inertia(model.coefficient, subject_);
    result.axis = axis_of(model.coefficient);
    result.model = model;
    result.row_interval_s = signals_.grid.step * static_cast<double>(signals_.stride);
    result.reason = identification_obstacle(model, signals_, subject_);
    return result;
  }

  RegressionOptions regression_options() const {
    RegressionOptions options;
    options.significance = options_.significance;
    options.signal_to_noise = options_.signal_to_noise;
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
      RegressionData data = coefficient_data(result.model, signals_, segments_.of(result.axis).identification, changed);
      static_cast<void>(assign_equation_error(data));
      const RegressionEstimate estimate = estimation::estimate(data, result.chosen->method, regression_options());
      return estimate.usable() ? estimate.theta : Eigen::VectorXd();
    };
    result.body_sensitivity = body_sensitivity(subject_, result.chosen->theta.size(), again);
    widen(*result.chosen, result.body_sensitivity, options_.significance);
    return dominant_constant(*result.chosen, result.body_sensitivity, subject_);
  }

  void estimate(CoefficientResult& result) const {
    const AxisSegments& axis = segments_.of(result.axis);
    result.data = coefficient_data(result.model, signals_, axis.identification, subject_);
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
    if (const RegressionEstimate* chosen = choose(result.comparison, options_.method)) {
      result.chosen = *chosen;
      for (std::size_t i = 0; i < result.model.size(); ++i)
        result.model.values[i] = chosen->theta(static_cast<Eigen::Index>(i));
    }
  }

  /// The terms of the model chosen among the candidates, by least squares on the identification rows.
  void choose_structure(CoefficientResult& result) const {
    CoefficientModel all{result.coefficient, options_.candidates[static_cast<std::size_t>(result.coefficient)], {}};
    if (all.terms.empty()) all.terms = default_candidates(result.model);
    // What the log does not have cannot be chosen.
    std::erase_if(all.terms, [&](const Term& term) {
      const CoefficientModel single{result.coefficient, {term}, {kUnknown}};
      return !identification_obstacle(single, signals_, subject_).empty();
    });
    all.values.assign(all.terms.size(), kUnknown);
    const RegressionData data = coefficient_data(all, signals_, segments_.of(result.axis).identification, subject_);
    if (all.terms.empty() || data.rows() < static_cast<Eigen::Index>(10 * all.size())) return;
    estimation::StructureOptions search;
    search.method = options_.structure == "stepwise" ? estimation::StructureMethod::kStepwise
                                                     : estimation::StructureMethod::kOrthogonal;
    search.significance = options_.significance;
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

    const AxisSegments& axis = segments_.of(result.axis);
    RegressionData unseen = coefficient_data(result.model, signals_, axis.holdout, subject_);
    const bool has_holdout = unseen.rows() >= static_cast<Eigen::Index>(10 * result.model.size());
    if (has_holdout) {
      result.holdout_fit = fit_on(unseen, chosen.theta);
      const auto n = unseen.parameters();
      unseen.error_covariance(n, n) = result.data.error_covariance(n, n);
      const RegressionEstimate again = estimation::estimate(unseen, chosen.method, regression_options());
      if (again.usable()) result.contradiction_p = contradiction_p(chosen, again);
    }
    if (options_.method == "auto" && !result.comparison.recommends) {
      return reject(fmt::format("{} is rejected: {}", name, result.comparison.reason));
    }
    if (!(result.unmodelled_share <= options_.max_unmodelled)) {
      return reject(fmt::format(
          "{} is rejected: {:.0f} % of its variance is neither modelled nor sensor noise (residual {:.1f} times what "
          "the "
          "sensors leave), so something that moves the aircraft is not among the regressors and biases them",
          name, 100.0 * result.unmodelled_share, std::sqrt(result.error_ratio)));
    }
    if (has_holdout && !(result.holdout_fit.r2 >= options_.min_holdout_r2)) {
      return reject(fmt::format(
          "{} is rejected: it explains {:.0f} % of the coefficient's variance on the hold-out, less than {:.0f} %",
          name, 100.0 * std::max(0.0, result.holdout_fit.r2), 100.0 * options_.min_holdout_r2));
    }
    if (has_holdout && !(result.contradiction_p >= options_.contradiction_level)) {
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
      result.reason += fmt::format("; not told apart from zero: {}", fmt::join(insignificant, ", "));
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
    for (const TimeSpan& span : segments_.airborne) {
      const auto [begin, end] = signals_.indices(span);
      for (std::size_t k = begin; k < end; k += signals_.stride) {
        const FlightSample<double> sample = signals_.sample(k);
        result.time.push_back(signals_.grid.at(k));
        if (!complete(sample, needed)) {
          result.measured.push_back(kNaN);
          result.modelled.push_back(kNaN);
          continue;
        }
        const double torque = signals_.torque.empty() ? 0.0 : signals_.torque[k];
        const double rho = signals_.air_density[k];
        result.measured.push_back(select(regressed_coefficients(sample, subject_, rho, torque), result.coefficient));
        result.modelled.push_back(estimated ? result.model.linear(aero_variables(sample, subject_, rho)) : kNaN);
      }
    }
  }

  const FlightSignals& signals_;
  const Segments& segments_;
  const Subject& subject_;
  const IdentifyOptions& options_;
};

}  // namespace

const char* to_string(CoefficientVerdict verdict) {
  switch (verdict) {
    case CoefficientVerdict::kIdentified:
      return "identified";
    case CoefficientVerdict::kNotExcited:
      return "not excited";
    case CoefficientVerdict::kRejected:
      return "rejected";
    case CoefficientVerdict::kSkipped:
      break;
  }
  return "skipped";
}

std::string identification_obstacle(const CoefficientModel& model, const FlightSignals& signals,
                                    const Subject& subject) {
  const std::string name = regressed_name(model.coefficient, subject);
  if (model.coefficient == Coefficient::kCD && !signals[FlightSignal::kThrust].available()) {
    return "CD needs the thrust: a channel, or throttle with a propulsion model in the subject";
  }
  for (const FlightSignal signal : needed_signals(model)) {
    if (!signals[signal].available()) {
      return fmt::format("{} needs {}, which the log does not have", name,
                         kFlightSignalNames[static_cast<std::size_t>(signal)]);
    }
  }
  return {};
}

Axis axis_of(Coefficient coefficient) {
  const bool longitudinal =
      coefficient == Coefficient::kCL || coefficient == Coefficient::kCD || coefficient == Coefficient::kCm;
  return longitudinal ? Axis::kLongitudinal : Axis::kLateral;
}

IdentifyOptions IdentifyOptions::read(const StudyTable& table) {
  IdentifyOptions options;
  if (table.has("coefficients")) {
    const std::vector<std::string> names(kCoefficientNames.begin(), kCoefficientNames.end());
    for (const std::string& name : table.texts("coefficients")) {
      const std::optional<Coefficient> c = find_coefficient(name);
      if (!c) table.fail("coefficients", fmt::format("'{}' is not a coefficient{}", name, suggestion(name, names)));
      options.coefficients.push_back(*c);
    }
  }
  const std::vector<std::string> methods{"auto", "OLS", "TLS", "GTLS", "PCA-GTLS"};
  options.method = table.choice_or("method", methods, options.method);
  options.refit_significant = table.flag_or("refit_significant", options.refit_significant);
  options.signal_to_noise = table.number_or("signal_to_noise", "1", options.signal_to_noise);
  if (!(options.signal_to_noise >= 1.0 && options.signal_to_noise <= 10.0)) {
    table.fail("signal_to_noise", fmt::format("= {} must be from 1 to 10", options.signal_to_noise));
  }
  options.significance = table.number_or("significance", "1", options.significance);
  if (!(options.significance > 0.0 && options.significance < 1.0)) {
    table.fail("significance", fmt::format("= {} must be between 0 and 1", options.significance));
  }
  options.min_holdout_r2 = table.number_or("min_holdout_r2", "1", options.min_holdout_r2);
  options.max_unmodelled = table.number_or("max_unmodelled", "1", options.max_unmodelled);
  options.contradiction_level = table.number_or("contradiction_level", "1", options.contradiction_level);
  const std::vector<std::string> structures{"given", "stepwise", "orthogonal"};
  options.structure = table.choice_or("structure", structures, options.structure);
  const StudyTable candidates = table.table_or_empty("candidates");
  for (std::size_t i = 0; i < kCoefficients; ++i) {
    if (!candidates.has(kCoefficientNames[i])) continue;
    for (const std::string& text : candidates.texts(kCoefficientNames[i])) {
      Term term = parse_term(text, candidates.place(kCoefficientNames[i]));
      auto& terms = options.candidates[i];
      if (std::find(terms.begin(), terms.end(), term) != terms.end())
        candidates.fail(kCoefficientNames[i], fmt::format("names the term '{}' twice", text));
      terms.push_back(std::move(term));
    }
  }
  if (table.has("candidates") && options.structure == "given")
    table.fail("candidates", "needs structure = \"stepwise\" or \"orthogonal\"");
  options.output_error = table.flag_or("output_error", options.output_error);
  options.output_error_gusts = table.flag_or("output_error_gusts", options.output_error_gusts);
  options.output_error_biases = table.flag_or("output_error_biases", options.output_error_biases);
  if (table.has("frequency_band")) {
    const std::vector<double> band = table.numbers("frequency_band", "Hz");
    if (band.size() != 2 || !(band[0] > 0.0) || !(band[1] > band[0]))
      table.fail("frequency_band", "must be two frequencies, 0 < low < high, such as [\"0.1 Hz\", \"2 Hz\"]");
    options.frequency_low_Hz = band[0];
    options.frequency_high_Hz = band[1];
  }
  const long long replicates = table.integer_or("bootstrap", 0);
  if (replicates != 0 && (replicates < 50 || replicates > 1000000))
    table.fail("bootstrap", fmt::format("= {} must be 0 (none) or from 50 to 1000000 replicates", replicates));
  options.bootstrap = static_cast<std::size_t>(replicates);
  return options;
}

Eigen::MatrixXd row_error_covariance(const CoefficientModel& model, const FlightSignals& signals, std::size_t k,
                                     const Subject& subject) {
  const auto n = static_cast<Eigen::Index>(model.size());
  Eigen::VectorXd classical = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(kFlightSignals));
  Eigen::VectorXd berkson = classical;
  for (std::size_t i = 0; i < kFlightSignals; ++i) {
    const GridSignal& signal = signals.signals[i];
    const double variance = signal.sigma * signal.sigma;
    if (signal.error == ErrorKind::kClassical) classical(static_cast<Eigen::Index>(i)) = variance;
    if (signal.error == ErrorKind::kBerkson) berkson(static_cast<Eigen::Index>(i)) = variance;
  }
  const CoefficientRow row = coefficient_row(model, signals.sample(k), subject, signals.air_density[k]);
  Eigen::MatrixXd W = row.jacobian * classical.asDiagonal() * row.jacobian.transpose();
  W(n, n) += row.jacobian.row(n).cwiseAbs2().dot(berkson);
  return W;
}

std::vector<Term> default_candidates(const CoefficientModel& model) {
  std::vector<Term> terms = model.terms;
  std::vector<const char*> usual{"1",          "beta",      "p_n",       "r_n",      "da",       "dr",
                                 "alpha*beta", "alpha*p_n", "alpha*r_n", "alpha*da", "alpha*dr", "beta^3"};
  if (axis_of(model.coefficient) == Axis::kLongitudinal)
    usual = {"1", "alpha", "q_n", "de", "alpha^2", "alpha*q_n", "alpha*de", "de^2"};
  for (const char* text : usual) {
    Term term = parse_term(text, "candidates");
    if (std::find(terms.begin(), terms.end(), term) == terms.end()) terms.push_back(std::move(term));
  }
  return terms;
}

RegressionData coefficient_data(const CoefficientModel& model, const FlightSignals& signals,
                                std::span<const TimeSpan> spans, const Subject& subject) {
  const std::vector<FlightSignal> needed = needed_signals(model);
  const auto n = static_cast<Eigen::Index>(model.size());
  std::vector<std::size_t> rows;
  std::vector<int> segment;
  int id = 0;
  for (const TimeSpan& span : spans) {
    const auto [begin, end] = signals.indices(span);
    ++id;
    for (std::size_t k = begin; k < end; k += signals.stride) {
      if (!complete(signals.sample(k), needed)) continue;
      // No lag and no transform is formed across a hole.
      if (!rows.empty() && segment.back() == id && rows.back() + signals.stride != k) ++id;
      rows.push_back(k);
      segment.push_back(id);
    }
  }
  RegressionData data;
  data.regressand_name = regressed_name(model.coefficient, subject);
  for (const Term& term : model.terms) {
    data.parameter_names.push_back(regressed_parameter_name(model.coefficient, term, subject));
    data.parameter_units.push_back(regressed_parameter_unit(model.coefficient, term, subject));
  }
  data.segment = std::move(segment);
  const auto count = static_cast<Eigen::Index>(rows.size());
  data.regressors.resize(count, n);
  data.regressand.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::size_t k = rows[static_cast<std::size_t>(i)];
    const FlightSample<double> sample = signals.sample(k);
    const double rho = signals.air_density[k];
    const double torque = signals.torque.empty() ? 0.0 : signals.torque[k];
    data.regressors.row(i) = model.regressors(aero_variables(sample, subject, rho)).transpose();
    data.regressand(i) = select(regressed_coefficients(sample, subject, rho, torque), model.coefficient);
  }
  if (count == 0) return data;

  // The Jacobian varies slowly: a mean over some of the rows.
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(n + 1, n + 1);
  const std::size_t step = std::max<std::size_t>(1, rows.size() / kCovarianceRows);
  std::size_t used = 0;
  for (std::size_t i = 0; i < rows.size(); i += step) {
    W += row_error_covariance(model, signals, rows[i], subject);
    ++used;
  }
  data.error_covariance = W / static_cast<double>(used);
  return data;
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

std::vector<Coefficient> identified_coefficients(std::span<const CoefficientResult> results) {
  std::vector<Coefficient> found;
  for (const CoefficientResult& result : results) {
    // Per unit inertia nothing can be flown.
    if (result.verdict == CoefficientVerdict::kIdentified && !result.per_unit_inertia)
      found.push_back(result.coefficient);
  }
  return found;
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

Subject identified_subject(const Subject& subject, std::span<const CoefficientResult> results) {
  Subject identified = subject;
  for (auto& coefficient : identified.model.coefficients) {
    if (coefficient) std::fill(coefficient->values.begin(), coefficient->values.end(), kUnknown);
  }
  for (const CoefficientResult& result : results) {
    if (result.verdict == CoefficientVerdict::kIdentified && !result.per_unit_inertia)
      identified.model.set(result.model);
  }
  return identified;
}

estimation::Estimate make_estimate(const Subject& subject, std::span<const CoefficientResult> results) {
  estimation::Estimate estimate;
  estimate.subject = subject.name;
  std::vector<std::string> methods;
  Eigen::Index total = 0;
  const auto listed = [](const CoefficientResult& result) {
    return result.chosen || result.verdict == CoefficientVerdict::kNotExcited;
  };
  for (const CoefficientResult& result : results) {
    if (listed(result)) total += static_cast<Eigen::Index>(result.model.size());
  }
  estimate.covariance = Eigen::MatrixXd::Zero(total, total);
  std::vector<std::pair<Eigen::Index, Eigen::MatrixXd>> shared;
  Eigen::Index at = 0;
  for (const CoefficientResult& result : results) {
    const std::string& name = result.name;
    if (!listed(result)) continue;
    if (!result.chosen) {
      // Nothing was estimated: the parameters are listed all the same, so that nobody takes silence for zero.
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
      const bool out = result.verdict == CoefficientVerdict::kNotExcited;
      estimate.parameters.push_back(
          {p.name, p.value, p.sigma, p.low95, p.high95, p.unit, out ? ParameterStatus::kNotExcited : p.status});
    }
    estimate.covariance.block(at, at, chosen.theta.size(), chosen.theta.size()) = chosen.covariance;
    // Coefficients are estimated apart, but share the errors of mass, geometry and inertia.
    shared.push_back({at, result.body_sensitivity});
    for (const auto& [other, G] : shared) {
      if (other == at || G.size() == 0 || result.body_sensitivity.size() == 0) continue;
      const Eigen::MatrixXd cross = result.body_sensitivity * G.transpose();
      estimate.covariance.block(at, other, cross.rows(), cross.cols()) = cross;
      estimate.covariance.block(other, at, cross.cols(), cross.rows()) = cross.transpose();
    }
    at += chosen.theta.size();
    estimate.fit[name + ".r2"] = result.identification_fit.r2;
    estimate.fit[name + ".residual_sd"] = chosen.residual_sd;
    estimate.fit[name + ".samples"] = static_cast<double>(chosen.rows);
    estimate.fit[name + ".error_ratio"] = result.error_ratio;
    estimate.fit[name + ".unmodelled_share"] = result.unmodelled_share;
    const std::string method(estimation::to_string(chosen.method));
    if (std::find(methods.begin(), methods.end(), method) == methods.end()) methods.push_back(method);
    if (result.holdout_fit.count > 0) {
      estimate.validation[name] = {result.holdout_fit.mae, result.holdout_fit.rmse, result.holdout_fit.r2,
                                   result.holdout_fit.theil, "1"};
    }
  }
  estimate.method = fmt::format("{}", fmt::join(methods, ", "));
  return estimate;
}

}  // namespace veridyn::aircraft
