#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/estimation/regression/equation_error.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/estimation/regression/regression_analysis.hpp"
#include "veridyn/estimation/regression/regression_evidence.hpp"
#include "veridyn/estimation/regression/total_least_squares.hpp"

namespace veridyn::estimation {
namespace {

constexpr double kScaleBand = 2.0;         // error variances are hardly ever known better than to a factor of two
constexpr double kSensitivityLimit = 2.0;  // sigmas
constexpr double kConditionLimit = 300.0;
constexpr double kInflationLimit = 10.0;  // usual limit, e.g. Klein & Morelli (2006) sec. 5.5

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
  Evidence check{
      .check = Check::kResidualAutocorrelation, .name = "residual autocorrelation", .scale = "Durbin-Watson"};
  check.value = estimate.whiteness.durbin_watson;
  check.limit = 2.0;
  check.outcome = passed_or(estimate.whiteness.white(), Outcome::kCare);
  double worst = 0.0;
  for (const Parameter& p : estimate.parameters) {
    if (p.sigma_white > 0.0 && std::isfinite(p.sigma)) worst = std::max(worst, p.sigma / p.sigma_white);
  }
  check.text = check.passed()
                   ? "the residual is white"
                   : fmt::format(
                         "the residual is autocorrelated (Durbin-Watson {:.2f}), which the error bars allow for: those "
                         "of white noise would be up to {:.1f} times too small",
                         check.value, std::max(1.0, worst));
  return check;
}

// Is the residual as large as W says? Chi-square with the effective number of samples.
Evidence error_scale(const RegressionEstimate& gtls, const Eigen::VectorXd& residual, const std::vector<int>& segment) {
  Evidence check{.check = Check::kErrorScale, .name = "error scale", .scale = "residual variance over assumed"};
  const double samples =
      numerics::effective_sample_size_variance({residual.data(), static_cast<std::size_t>(residual.size())}, segment);
  const double low = std::min(1.0 / kScaleBand, numerics::chi_square_quantile(0.005, samples) / samples);
  const double high = std::max(kScaleBand, numerics::chi_square_quantile(0.995, samples) / samples);
  check.value = gtls.error_scale;
  check.limit = gtls.error_scale > 1.0 ? high : low;
  check.outcome = passed_or(gtls.error_scale >= low && gtls.error_scale <= high, Outcome::kCare);
  const double p = numerics::chi_square_upper_p(samples * gtls.error_scale, samples);
  check.text = fmt::format(
      "residual variance is {:.3g} of what the assumed errors give (trusted within {:.2g} to {:.3g}; {:.0f} effective "
      "samples, p = {:.2g})",
      check.value, low, high, samples, 2.0 * std::min(p, 1.0 - p));
  return check;
}

Evidence ols_agreement(const RegressionEstimate& ols, const RegressionEstimate& candidate) {
  const std::string_view name = to_string(candidate.method);
  const Distance gap = distance(candidate, candidate.theta, ols.theta);
  Evidence check{.check = Check::kOlsAgreement,
                 .name = "agreement of OLS",
                 .outcome = passed_or(gap.sigmas <= kSensitivityLimit, Outcome::kCare),
                 .value = gap.sigmas,
                 .limit = kSensitivityLimit,
                 .scale = "sigma"};
  check.text = check.passed() ? fmt::format("OLS and {} agree to {:.1f} sigma", name, gap.sigmas)
                              : fmt::format("OLS is {:.1f} sigma of {} away in {}: errors of the regressors matter",
                                            gap.sigmas, name, gap.parameter);
  return check;
}

/// What a residual of another size than the assumed errors says changes when it is read the other way: all of it as
/// equation error, or as smaller errors of the regressors.
struct OtherReading {
  bool too_large = false;                ///< is the residual larger than the errors say?
  std::optional<Eigen::VectorXd> theta;  ///< under the other reading; none: it has no solution
  Distance moved;                        ///< of the candidate to it
  Evidence check;                        ///< whether that matters
};

/// `raised` is W with equation error.
OtherReading read_otherwise(const internal::RegressionAnalysis& analysis, const RegressionEstimate& candidate,
                            const Eigen::MatrixXd& raised) {
  const Eigen::MatrixXd& W = analysis.data().error_covariance;
  OtherReading out;
  out.too_large = candidate.error_scale > 1.0;
  out.theta = analysis.theta_under(
      candidate.method,
      out.too_large ? raised : with_smaller_regressor_errors(analysis.triangle(), W, analysis.rows()));
  out.moved = out.theta ? distance(candidate, candidate.theta, *out.theta) : Distance{kInfinity, ""};
  const Distance& moved = out.moved;
  out.check = {.check = Check::kErrorRatioSensitivity,
               .name = "sensitivity to the error ratio",
               .outcome = passed_or(moved.sigmas <= kSensitivityLimit, Outcome::kCare),
               .value = moved.sigmas,
               .limit = kSensitivityLimit,
               .scale = "sigma"};
  out.check.text =
      !out.theta
          ? std::string("with the other reading of the mismatch there is no estimate")
          : fmt::format("{} moves {:.1f} sigma at most{} if {}", to_string(candidate.method), moved.sigmas,
                        moved.parameter.empty() ? "" : fmt::format(" ({})", moved.parameter),
                        out.too_large ? "what the assumed errors leave unexplained is error of the equation alone"
                                      : "the regressors' errors are smaller than assumed");
  return out;
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
  result.checks.push_back(collinearity(held ? *pca : ols));
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

Evidence collinearity(const RegressionEstimate& estimate) {
  Evidence check{.check = Check::kCollinearity,
                 .name = "collinearity",
                 .value = estimate.condition_number,
                 .limit = kConditionLimit,
                 .scale = "condition number",
                 .bears_on = Purpose::kParameters};
  double largest = 1.0;
  std::vector<std::string> names;
  for (const Parameter& p : estimate.parameters) {
    if (p.status == ParameterStatus::kNotExcited || p.status == ParameterStatus::kFixed) continue;
    largest = std::max(largest, p.variance_inflation);
    if (p.variance_inflation > kInflationLimit) names.push_back(p.name);
  }
  check.text = fmt::format("condition number {:.3g}, largest variance inflation {:.3g}", check.value, largest);
  if (!estimate.unexcited.empty()) {
    // The condition number is that of all directions; those that are not excited are held and reported as such.
    check.value = largest;
    check.limit = kInflationLimit;
    check.scale = "variance inflation";
    check.text = fmt::format("largest variance inflation {:.3g}, with what is not excited held", largest);
  }
  check.outcome = passed_or(check.value <= check.limit && names.empty(), Outcome::kCare);
  if (!names.empty()) {
    check.text = fmt::format("the regressors of {} move together (variance inflation up to {:.3g})",
                             fmt::join(names, ", "), largest);
    check.advice = "excite them separately: move one control at a time, in its own manoeuvre";
  }
  return check;
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
  result.checks.push_back(collinearity(candidate.usable() ? candidate : ols));
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

  Evidence scale = error_scale(candidate, analysis.residual(candidate.theta), data.segment);
  if (!data.regressand_error_known && candidate.error_scale > 1.0)
    scale.outcome = Outcome::kPassed;  // only rounding above 1: the excess is in W already
  result.checks.push_back(scale);
  const Eigen::MatrixXd raised = with_equation_error(analysis.triangle(), data.error_covariance, analysis.rows());
  if (const auto theta = analysis.theta_under(Method::kGtls, raised)) result.theta_with_equation_error = *theta;
  const OtherReading other = read_otherwise(analysis, candidate, raised);
  result.checks.push_back(other.check);

  if (scale.passed()) {
    return recommend(std::move(result), candidate.method,
                     fmt::format("{}: the residual is as large as the assumed errors say (ratio {:.2g})", name,
                                 candidate.error_scale));
  }
  if (other.check.passed()) {
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
