#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/estimation/regression/regression_data.hpp"
#include "veridyn/estimation/result/parameter.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::estimation {

/// How a regression is solved: where the errors are taken to be.
enum class Method {
  kOls,     ///< ordinary least squares: all error in z
  kTls,     ///< total least squares: equal, uncorrelated errors in every column that is not exact
  kGtls,    ///< generalised total least squares: errors of covariance W
  kPcaGtls  ///< GTLS over the directions that exceed the noise; the rest is reported as not excited
};
/// "OLS", "TLS", "GTLS", "PCA-GTLS".
[[nodiscard]] std::string_view to_string(Method method);

/// How an estimation ended.
enum class EstimateTermination {
  kEstimated,      ///< an estimate with covariance
  kRankDeficient,  ///< regressors are linearly dependent to rounding: no unique estimate (PCA-GTLS still gives one)
  kNongeneric,  ///< the smallest singular value belongs to the regressors alone: no TLS solution, or noise as large as
                ///< signal
  kTooFewRows   ///< fewer independent rows than parameters
};
[[nodiscard]] std::string_view to_string(EstimateTermination termination);

/// Which covariance the error bars come from.
enum class CovarianceKind {
  kWhite,          ///< errors uncorrelated in time; 1.6 to 3 times too small on real flight
  kAutocorrelated  ///< OLS: Morelli & Klein (1997), residual autocorrelation; TLS family: `score_covariance`. The
                   ///< default
};

/// How a regression is estimated and tested.
struct RegressionOptions {
  CovarianceKind covariance = CovarianceKind::kAutocorrelated;
  /// Two-sided level of the t-tests; intervals `low95`, `high95` are always 95 %.
  double significance = 0.05;
  /// S/n of the threshold (S/n + 1) sqrt(N - n_p) on the singular values of D C^-1, in [1, 10]. Since s_j^2 is signal
  /// plus noise power, the default 1 asks for three times as much signal as noise power in a direction (10: 120 times).
  /// Below it GTLS may still be accurate when there are many rows: its error bars say so; PCA-GTLS does not rely on it.
  double signal_to_noise = 1.0;
  /// Prior theta_0 for what is not excited; empty means 0.
  Eigen::VectorXd prior = {};
  /// Weights of |W (theta - theta_0)| over what is not excited, one a parameter, > 0; infinity pins the parameter to
  /// its prior. PCA-GTLS only; the other methods have no prior. Empty means 1.
  Eigen::VectorXd prior_weight = {};
  /// B_0: 95 % bound on |W (theta - theta_0)| along a direction that was not excited. 0 chooses
  /// 10 max(1, largest |W (theta - theta_0)|_i of the estimate), but never below 1.96 sigma of GTLS in that direction.
  double unexcited_bound = 0.0;
  /// Longest lag of residual correlation that is looked for [samples].
  Eigen::Index max_lag = 500;
  /// Rows of the normal probability plot kept.
  std::size_t normal_plot_points = 200;

  /// @throws InputError naming the option, its value and its rule.
  void validate(Eigen::Index parameters) const;
};

/// A combination of parameters and how well the data excite it.
struct Direction {
  Eigen::VectorXd combination;  ///< unit vector over the parameters
  double bound95 = 0.0;         ///< assumed bound on its length (B_0)
  std::string text;             ///< "0.71 CY_p + 0.70 CY_r"
};

/// Result of one method, whatever the method.
struct RegressionEstimate {
  Method method = Method::kOls;
  EstimateTermination termination = EstimateTermination::kTooFewRows;
  std::string message;  ///< one sentence: what came out, or why nothing did
  std::vector<Parameter> parameters;
  Eigen::VectorXd theta;             ///< n_p; the values of `parameters`
  Eigen::MatrixXd covariance;        ///< of the chosen kind, unexcited bound included
  Eigen::MatrixXd covariance_white;  ///< the same with errors taken as white
  double degrees_of_freedom = 0.0;   ///< of the t-tests: N - n_p, fewer when the residual is autocorrelated
  Eigen::Index lag_window = 0;       ///< lags at which correlation enters the covariance in full [samples]

  Eigen::Index rows = 0;
  double residual_sd = 0.0;  ///< of z - X theta, unit of z
  double r_squared = 0.0;    ///< 1 - residual power / power of z about its mean
  /// Estimated factor on W (OLS: 0 where W is unknown): 1 when model and assumed errors are right.
  double error_scale = 0.0;
  numerics::WhitenessTest whiteness;
  numerics::NormalPlot normal_plot;

  std::vector<double>
      singular_values;     ///< TLS family: of the whitened [X z] without exact columns, descending; OLS: of X
  double threshold = 0.0;  ///< PCA-GTLS: directions with larger singular values are excited
  Eigen::Index excited_directions = 0;
  std::vector<Direction> unexcited;  ///< PCA-GTLS: what the data do not determine
  double condition_number = 0.0;     ///< of X with columns scaled to unit length

  /// Is there an estimate with an error bar?
  [[nodiscard]] bool usable() const { return termination == EstimateTermination::kEstimated; }
  [[nodiscard]] const Parameter* find(std::string_view name) const;
};

/// All methods on the same data, from one pass over it, and which one is recommended.
struct RegressionComparison {
  std::vector<RegressionEstimate> estimates;  ///< OLS, TLS, GTLS, PCA-GTLS (without W: OLS, TLS)
  std::vector<Evidence> checks;    ///< but for `collinearity`, which depends on what the caller knows of noise
  Method examined = Method::kOls;  ///< whose regressors and residual the checks are of
  bool recommends = false;
  Method recommended = Method::kOls;  ///< meaningful when `recommends`
  std::string reason;                 ///< one sentence, whether it recommends or refuses

  /// GTLS with the part of the residual that W does not explain assigned to z alone (equation error, Fuller 1987
  /// sec. 2.2); when it differs from GTLS the assumed error ratio matters. Empty without absolute W.
  Eigen::VectorXd theta_with_equation_error;

  [[nodiscard]] const RegressionEstimate* find(Method method) const;
  /// That whose regressors were examined; null before any comparison.
  [[nodiscard]] const RegressionEstimate* examined_estimate() const { return find(examined); }
  /// The recommended estimate, or null when none is.
  [[nodiscard]] const RegressionEstimate* best() const { return recommends ? find(recommended) : nullptr; }
};

/// One estimate. @throws InputError when data or options are wrong.
[[nodiscard]] RegressionEstimate estimate(const RegressionData& data, Method method,
                                          const RegressionOptions& options = {});

/// Runs every method and judges: autocorrelation of the residual; scale of the GTLS residual against W (chi-square with
/// the effective number of samples); how far the answer moves if excess residual is equation error; agreement of the
/// methods in units of sigma; collinearity. Statuses of a refused comparison stay as estimated: callers turn them into
/// `rejected` with `marked`.
/// @throws InputError when data or options are wrong.
[[nodiscard]] RegressionComparison compare(const RegressionData& data, const RegressionOptions& options = {});

/// Widens covariance and intervals by a factor on the variance, as of estimates from several parts that scatter more
/// than their error bars say (Birge 1932); what is then no longer distinguishable from zero at the level `significance`
/// becomes insignificant. A factor of 1 or less changes nothing.
void widen(RegressionEstimate& estimate, double variance_factor, double significance);

/// A combination in words: terms of at least 5 % of the largest, e.g. "0.71 CY_p - 0.70 CY_r".
[[nodiscard]] std::string describe_combination(const Eigen::VectorXd& combination,
                                               const std::vector<std::string>& names);

}  // namespace veridyn::estimation
