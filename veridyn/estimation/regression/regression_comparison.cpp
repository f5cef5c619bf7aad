#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/estimation/judgement/limits.hpp"
#include "veridyn/estimation/regression/equation_error.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/estimation/regression/regression_analysis.hpp"
#include "veridyn/estimation/regression/regression_evidence.hpp"
#include "veridyn/estimation/regression/total_least_squares.hpp"

namespace veridyn::estimation {
namespace {

struct Distance {
  double sigmas = 0.0;
  std::string parameter;
};

// Largest difference between two estimates in sigmas of `scale`, over the parameters it estimates.
Distance distance(const RegressionEstimate& scale, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  Distance largest;
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    const Parameter& p = scale.parameters[i];
    if (p.status == ParameterStatus::kFixed || p.status == ParameterStatus::kNotExcited || !(p.sigma > 0.0)) continue;
    const double sigmas = std::abs(a(i) - b(i)) / p.sigma;
    if (sigmas > largest.sigmas) largest = {sigmas, p.name};
  }
  return largest;
}

Evidence residual_autocorrelation(const RegressionEstimate& estimate) {
  double worst = 1.0;
  for (const Parameter& p : estimate.parameters) {
    if (p.sigma_white > 0.0 && std::isfinite(p.sigma)) worst = std::max(worst, p.sigma / p.sigma_white);
  }
  return row_of(Check::kResidualAutocorrelation, "", estimate.whiteness.p_value)
      .with("durbin_watson", estimate.whiteness.durbin_watson)
      .with("factor", worst);
}

/// Is the residual as large as W says? Chi-square with the effective number of samples.
/// @param excess_in_W  what is above 1 is rounding: W has been raised by it already
Evidence error_scale(const RegressionEstimate& gtls, const Eigen::VectorXd& residual, const std::vector<int>& segment,
                     bool excess_in_W) {
  const Tolerance& known = info_of(Check::kErrorScale).tolerance;
  const double samples =
      numerics::effective_sample_size_variance({residual.data(), static_cast<std::size_t>(residual.size())}, segment);
  const double low = std::min(known.low, numerics::chi_square_quantile(0.005, samples) / samples);
  const double high =
      excess_in_W ? kInfinity : std::max(known.high, numerics::chi_square_quantile(0.995, samples) / samples);
  const double scale = gtls.error_scale;
  Evidence row = row_of(Check::kErrorScale, "", passed_or(scale >= low && scale <= high, Outcome::kCare));
  row.value = scale;
  row.limit = scale > 1.0 ? high : low;
  if (!row.passed()) row.cause = Cause::kNoise;
  const double p = numerics::chi_square_upper_p(samples * scale, samples);
  return std::move(row)
      .with("low", low)
      .with("high", high)
      .with("samples", samples)
      .with("p", 2.0 * std::min(p, 1.0 - p));
}

Evidence ols_agreement(const RegressionEstimate& ols, const RegressionEstimate& candidate) {
  const Distance gap = distance(candidate, candidate.theta, ols.theta);
  return row_of(Check::kOlsAgreement, "", gap.sigmas)
      .with("method", std::string(to_string(candidate.method)))
      .with("parameter", gap.parameter);
}

/// What a residual of another size than the assumed errors says changes when it is laid elsewhere: all of it to the
/// equation, or to smaller errors of the regressors.
struct OtherReading {
  bool too_large = false;                ///< is the residual larger than the errors say?
  std::optional<Eigen::VectorXd> theta;  ///< under the other reading; none: it has no solution
  Distance moved;                        ///< of the candidate to it
};

/// `raised` is W with equation error.
OtherReading with_other_errors(const internal::RegressionAnalysis& analysis, const RegressionEstimate& candidate,
                               const Eigen::MatrixXd& raised) {
  const Eigen::MatrixXd& W = analysis.data().error_covariance;
  OtherReading out;
  out.too_large = candidate.error_scale > 1.0;
  out.theta = analysis.theta_under(
      candidate.method,
      out.too_large ? raised : with_smaller_regressor_errors(analysis.triangle(), W, analysis.rows()));
  out.moved = out.theta ? distance(candidate, candidate.theta, *out.theta) : Distance{kInfinity, ""};
  return out;
}

Evidence sensitivity_row(const OtherReading& other, const RegressionEstimate& candidate) {
  Evidence row = row_of(Check::kErrorRatioSensitivity, "", other.moved.sigmas);
  if (!row.passed()) row.cause = !other.theta ? Cause::kMissing : other.too_large ? Cause::kMissingTerm : Cause::kNoise;
  return std::move(row)
      .with("method", std::string(to_string(candidate.method)))
      .with("parameter", other.moved.parameter);
}

RegressionComparison recommend(RegressionComparison comparison, Method method, std::string reason) {
  comparison.recommends = true;
  comparison.recommended = method;
  comparison.reason = std::move(reason);
  return comparison;
}

RegressionComparison refuse(RegressionComparison comparison, std::string reason) {
  comparison.recommends = false;
  comparison.reason = std::move(reason);
  return comparison;
}

RegressionComparison compare_with_exact_regressors(RegressionComparison result, bool errors_given) {
  const RegressionEstimate& ols = result.estimates[0];
  const RegressionEstimate* pca = result.find(Method::kPcaGtls);
  const bool held = !ols.usable() && pca != nullptr && pca->usable();
  if (held) result.examined = Method::kPcaGtls;
  result.checks.push_back(residual_autocorrelation(ols));
  if (ols.usable()) {
    return recommend(std::move(result), Method::kOls,
                     errors_given ? "OLS: the regressors are exact"
                                  : "OLS: no errors of the regressors are given, so they are taken as exact");
  }
  if (held) {
    std::string reason = fmt::format("PCA-GTLS: {}", pca->message);
    return recommend(std::move(result), Method::kPcaGtls, std::move(reason));
  }
  std::string reason = fmt::format("none: {}", ols.message);
  return refuse(std::move(result), std::move(reason));
}

}  // namespace

Evidence collinearity(const RegressionEstimate& estimate, bool noise_alone) {
  double inflation = 1.0;
  std::vector<std::string> together, all;
  for (const Parameter& p : estimate.parameters) {
    if (p.status == ParameterStatus::kNotExcited || p.status == ParameterStatus::kFixed) continue;
    inflation = std::max(inflation, p.variance_inflation);
    all.push_back(p.name);
    if (p.variance_inflation > kMostInflation) together.push_back(p.name);
  }
  // The condition number is that of all directions; those that are not excited are held and reported as such.
  const bool held = !estimate.unexcited.empty();
  const Outcome outcome =
      held ? Outcome::kPassed : outcome_of(estimate.condition_number, 0.0, info_of(Check::kCollinearity).tolerance);
  const bool by_inflation = held || (!together.empty() && outcome != Outcome::kFailed);
  Evidence row = by_inflation ? row_of(Check::kVarianceInflation, "", inflation)
                              : row_of(Check::kCollinearity, "", estimate.condition_number);
  if (!row.passed()) row.cause = Cause::kCollinear;
  if (noise_alone && row.outcome == Outcome::kCare) row.outcome = Outcome::kPassed;
  return std::move(row)
      .with("inflation", inflation)
      .with("names", fmt::format("{}", fmt::join(together.empty() ? all : together, ", ")));
}

bool is_collinearity(const Evidence& row) {
  return row.check == Check::kCollinearity || row.check == Check::kVarianceInflation;
}

RegressionComparison compare(const RegressionData& data, const RegressionOptions& options) {
  const internal::RegressionAnalysis analysis(data, options);
  RegressionComparison result;
  const Eigen::Index n = data.parameters();
  const bool with_errors =
      data.has_error_covariance() && data.error_covariance.topLeftCorner(n, n).diagonal().maxCoeff() > 0.0;
  std::vector<Method> methods = {Method::kOls, Method::kTls};
  if (data.has_error_covariance()) methods.insert(methods.end(), {Method::kGtls, Method::kPcaGtls});
  for (const Method method : methods) result.estimates.push_back(analysis.run(method));
  if (!with_errors) return compare_with_exact_regressors(std::move(result), data.has_error_covariance());

  const RegressionEstimate ols = result.estimates[0];
  const RegressionEstimate& pca = *result.find(Method::kPcaGtls);
  const RegressionEstimate candidate = pca.usable() && !pca.unexcited.empty() ? pca : *result.find(Method::kGtls);
  const std::string name(to_string(candidate.method));
  result.examined = candidate.usable() ? candidate.method : Method::kOls;
  result.checks.push_back(residual_autocorrelation(candidate));
  if (!candidate.usable())
    return refuse(std::move(result), fmt::format("none: {} found nothing: {}", name, candidate.message));
  if (ols.usable()) result.checks.push_back(ols_agreement(ols, candidate));
  if (!data.error_scale_known) {
    return recommend(std::move(result), candidate.method,
                     fmt::format("{}: under the given ratio of errors, which these data cannot test (its scale is not "
                                 "given)",
                                 name));
  }

  const Evidence scale = error_scale(candidate, analysis.residual(candidate.theta), data.segment,
                                     !data.regressand_error_known && candidate.error_scale > 1.0);
  result.checks.push_back(scale);
  const Eigen::MatrixXd raised = with_equation_error(analysis.triangle(), data.error_covariance, analysis.rows());
  if (const auto theta = analysis.theta_under(Method::kGtls, raised)) result.theta_with_equation_error = *theta;
  const OtherReading other = with_other_errors(analysis, candidate, raised);
  const Evidence sensitivity = sensitivity_row(other, candidate);
  result.checks.push_back(sensitivity);

  if (scale.passed()) {
    return recommend(std::move(result), candidate.method,
                     fmt::format("{}: the residual is as large as the assumed errors say (ratio {:.2g})", name,
                                 candidate.error_scale));
  }
  if (sensitivity.passed()) {
    return recommend(std::move(result), candidate.method,
                     fmt::format("{}: the residual variance is {:.2g} of what the assumed errors give, but the "
                                 "estimate moves only {:.1f} sigma by it",
                                 name, candidate.error_scale, other.moved.sigmas));
  }
  if (ols.usable() && other.theta) {
    const Distance gap = distance(ols, ols.theta, *other.theta);
    if (gap.sigmas <= 1.0) {
      return recommend(std::move(result), Method::kOls,
                       fmt::format("OLS: the residual variance is {:.2g} of what the assumed errors give; with that "
                                   "corrected the errors of the regressors matter by {:.1f} sigma at most",
                                   candidate.error_scale, gap.sigmas));
    }
  }
  return refuse(std::move(result),
                fmt::format("none: the residual variance is {:.2g} of what the assumed errors give, and {} depends on "
                            "where the difference lies ({:.1f} sigma{}); {}",
                            candidate.error_scale, name, other.moved.sigmas,
                            other.moved.parameter.empty() ? "" : " in " + other.moved.parameter,
                            other.too_large ? "the model is incomplete or the errors are larger than assumed"
                                            : "the errors are smaller than assumed"));
}

}  // namespace veridyn::estimation
