#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/regression/equation_error.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/estimation/regression/regression_analysis.hpp"
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
    const ParameterEstimate& p = scale.parameters[static_cast<std::size_t>(i)];
    if (p.status == ParameterStatus::kFixed || p.status == ParameterStatus::kNotExcited || !(p.sigma > 0.0)) continue;
    const double sigmas = std::abs(a(i) - b(i)) / p.sigma;
    if (sigmas > largest.sigmas) largest = {sigmas, p.name};
  }
  return largest;
}

HonestyCheck residual_colour(const RegressionEstimate& estimate) {
  HonestyCheck check{.name = "residual colour"};
  check.value = estimate.whiteness.durbin_watson;
  check.limit = 2.0;
  check.passed = estimate.whiteness.white();
  double worst = 0.0;
  for (const ParameterEstimate& p : estimate.parameters) {
    if (p.sigma_white > 0.0 && std::isfinite(p.sigma)) worst = std::max(worst, p.sigma / p.sigma_white);
  }
  check.text = check.passed
                   ? "the residual is white"
                   : fmt::format(
                         "the residual is autocorrelated (Durbin-Watson {:.2f}): white-noise error bars would be up "
                         "to {:.1f} times too small",
                         check.value, std::max(1.0, worst));
  return check;
}

HonestyCheck collinearity(const RegressionEstimate& ols) {
  HonestyCheck check{.name = "collinearity"};
  check.value = ols.condition_number;
  check.limit = kConditionLimit;
  const auto worst = std::max_element(ols.parameters.begin(), ols.parameters.end(), [](const auto& a, const auto& b) {
    return a.variance_inflation < b.variance_inflation;
  });
  check.passed = check.value <= kConditionLimit && worst->variance_inflation <= kInflationLimit;
  check.text = fmt::format("condition number {:.3g}, largest variance inflation {:.3g} ({})", check.value,
                           worst->variance_inflation, worst->name);
  return check;
}

// Is the residual as large as W says? Chi-square with the effective number of samples.
HonestyCheck error_scale(const RegressionEstimate& gtls, const Eigen::VectorXd& residual,
                         const std::vector<int>& segment) {
  HonestyCheck check{.name = "error scale"};
  const double samples =
      numerics::effective_sample_size_variance({residual.data(), static_cast<std::size_t>(residual.size())}, segment);
  const double low = std::min(1.0 / kScaleBand, numerics::chi_square_quantile(0.005, samples) / samples);
  const double high = std::max(kScaleBand, numerics::chi_square_quantile(0.995, samples) / samples);
  check.value = gtls.error_scale;
  check.limit = gtls.error_scale > 1.0 ? high : low;
  check.passed = gtls.error_scale >= low && gtls.error_scale <= high;
  const double p = numerics::chi_square_upper_p(samples * gtls.error_scale, samples);
  check.text = fmt::format(
      "residual variance is {:.3g} of what the assumed errors give (trusted within {:.2g} to {:.3g}; {:.0f} effective "
      "samples, p = {:.2g})",
      check.value, low, high, samples, 2.0 * std::min(p, 1.0 - p));
  return check;
}

}  // namespace

RegressionComparison compare(const RegressionData& data, const RegressionOptions& options) {
  const internal::RegressionAnalysis analysis(data, options);
  RegressionComparison result;
  const Eigen::Index n = data.parameters();
  const bool with_errors =
      data.has_error_covariance() && data.error_covariance.topLeftCorner(n, n).diagonal().maxCoeff() > 0.0;
  std::vector<Method> methods = {Method::kOls, Method::kTls};
  if (data.has_error_covariance()) methods.insert(methods.end(), {Method::kGtls, Method::kPcaGtls});
  for (const Method method : methods) result.estimates.push_back(analysis.run(method));
  const RegressionEstimate& ols = result.estimates[0];

  result.checks.push_back(collinearity(ols));
  const auto refuse = [&](std::string reason) {
    result.recommends = false;
    result.reason = std::move(reason);
    return result;
  };
  const auto recommend = [&](Method method, std::string reason) {
    result.recommends = true;
    result.recommended = method;
    result.reason = std::move(reason);
    return result;
  };

  if (!with_errors) {
    result.checks.push_back(residual_colour(ols));
    if (!ols.usable()) {
      const RegressionEstimate* pca = result.find(Method::kPcaGtls);
      if (pca != nullptr && pca->usable())
        return recommend(Method::kPcaGtls, fmt::format("PCA-GTLS: {}", pca->message));
      return refuse(fmt::format("none: {}", ols.message));
    }
    return recommend(Method::kOls, data.has_error_covariance()
                                       ? "OLS: the regressors are exact"
                                       : "OLS: no errors of the regressors are given, so they are taken as exact");
  }

  const RegressionEstimate& gtls = *result.find(Method::kGtls);
  const RegressionEstimate& pca = *result.find(Method::kPcaGtls);
  const RegressionEstimate& candidate = pca.usable() && !pca.unexcited.empty() ? pca : gtls;
  const std::string name(to_string(candidate.method));
  result.checks.push_back(residual_colour(candidate));
  if (!candidate.usable()) return refuse(fmt::format("none: {} found nothing: {}", name, candidate.message));

  if (ols.usable()) {
    const Distance apart = distance(candidate, candidate.theta, ols.theta);
    HonestyCheck agreement{.name = "agreement of OLS",
                           .passed = apart.sigmas <= kSensitivityLimit,
                           .value = apart.sigmas,
                           .limit = kSensitivityLimit};
    agreement.text = agreement.passed
                         ? fmt::format("OLS and {} agree to {:.1f} sigma", name, apart.sigmas)
                         : fmt::format("OLS is {:.1f} sigma of {} away in {}: errors of the regressors matter",
                                       apart.sigmas, name, apart.parameter);
    result.checks.push_back(agreement);
  }
  if (!data.error_scale_known) {
    return recommend(
        candidate.method,
        fmt::format("{}: under the given ratio of errors, which these data cannot test (its scale is not given)",
                    name));
  }

  const Eigen::MatrixXd& W = data.error_covariance;
  HonestyCheck scale = error_scale(candidate, analysis.residual(candidate.theta), data.segment);
  const bool too_large = candidate.error_scale > 1.0;
  if (!data.regressand_error_known && too_large)
    scale.passed = true;  // only rounding above 1: the excess is in W already
  result.checks.push_back(scale);

  // The answer if the mismatch is on one side only.
  const TotalLeastSquares raised = total_least_squares(
      analysis.triangle(), with_equation_error(analysis.triangle(), W, analysis.rows()), analysis.rows());
  if (raised.solved) result.theta_with_equation_error = raised.theta;
  const TotalLeastSquares other =
      too_large ? raised
                : total_least_squares(analysis.triangle(),
                                      with_smaller_regressor_errors(analysis.triangle(), W, analysis.rows()),
                                      analysis.rows());
  HonestyCheck sensitivity{.name = "sensitivity to the error ratio", .limit = kSensitivityLimit};
  const Distance moved = other.solved ? distance(candidate, candidate.theta, other.theta) : Distance{kInfinity, ""};
  sensitivity.value = moved.sigmas;
  sensitivity.passed = moved.sigmas <= kSensitivityLimit;
  sensitivity.text =
      !other.solved ? std::string("with the other reading of the mismatch there is no estimate")
                    : fmt::format("{} moves {:.1f} sigma at most{} if {}", name, moved.sigmas,
                                  moved.parameter.empty() ? "" : fmt::format(" ({})", moved.parameter),
                                  too_large ? "what the assumed errors leave unexplained is error of the equation alone"
                                            : "the regressors' errors are smaller than assumed");
  result.checks.push_back(sensitivity);

  if (scale.passed) {
    return recommend(candidate.method,
                     fmt::format("{}: the residual is as large as the assumed errors say (ratio {:.2g})", name,
                                 candidate.error_scale));
  }
  if (sensitivity.passed) {
    return recommend(candidate.method, fmt::format("{}: the residual variance is {:.2g} of what the assumed errors "
                                                   "give, but the estimate moves only {:.1f} sigma by it",
                                                   name, candidate.error_scale, moved.sigmas));
  }
  if (ols.usable() && other.solved) {
    const Distance apart = distance(ols, ols.theta, other.theta);
    if (apart.sigmas <= 1.0) {
      return recommend(Method::kOls,
                       fmt::format("OLS: the residual variance is {:.2g} of what the assumed errors give; with that "
                                   "corrected the errors of the regressors matter by {:.1f} sigma at most",
                                   candidate.error_scale, apart.sigmas));
    }
  }
  return refuse(
      fmt::format("none: the residual variance is {:.2g} of what the assumed errors give, and {} depends on where the "
                  "difference lies ({:.1f} sigma{}); {}",
                  candidate.error_scale, name, moved.sigmas, moved.parameter.empty() ? "" : " in " + moved.parameter,
                  too_large ? "the model is incomplete or the errors are larger than assumed"
                            : "the errors are smaller than assumed"));
}

}  // namespace veridyn::estimation
