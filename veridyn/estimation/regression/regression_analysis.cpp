#include "veridyn/estimation/regression/regression_analysis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/regression/augmented_qr.hpp"
#include "veridyn/estimation/regression/equation_error.hpp"
#include "veridyn/estimation/regression/pca_total_least_squares.hpp"
#include "veridyn/estimation/regression/total_least_squares.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::estimation::internal {
namespace {

constexpr double kAutomaticBound = 10.0;

// Pinned parameters moved to the regressand: [X, z] P = [X_free, z - X_pinned theta_0].
struct Pinning {
  std::vector<Eigen::Index> free;
  Eigen::MatrixXd P;
};

Pinning pin_parameters(const Eigen::VectorXd& prior, const Eigen::VectorXd& weight) {
  const Eigen::Index n = prior.size();
  Pinning pinning;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (std::isfinite(weight(i))) pinning.free.push_back(i);
  }
  const auto count = signed_index(pinning.free.size());
  pinning.P = Eigen::MatrixXd::Zero(n + 1, count + 1);
  for (Eigen::Index j = 0; j < count; ++j) pinning.P(pinning.free[j], j) = 1.0;
  pinning.P(n, count) = 1.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!std::isfinite(weight(i))) pinning.P(i, count) = -prior(i);
  }
  return pinning;
}

/// What is estimated when pinned parameters are moved to the regressand.
struct FreeParameters {
  Pinning pinning;
  Eigen::VectorXd all_prior, all_weight;  ///< of all parameters
  Eigen::VectorXd prior, weight;          ///< of the free ones
  Eigen::MatrixXd triangle;               ///< of [X_free, z]
  Eigen::MatrixXd error_covariance;       ///< W of [X_free, z]
  Eigen::MatrixXd lift;                   ///< all parameters by free ones

  [[nodiscard]] Eigen::Index count() const { return prior.size(); }
  /// All parameters, pinned ones at their prior.
  [[nodiscard]] Eigen::VectorXd all_values(const Eigen::VectorXd& free) const {
    Eigen::VectorXd theta = lift * free;
    for (Eigen::Index i = 0; i < theta.size(); ++i) {
      if (!std::isfinite(all_weight(i))) theta(i) = all_prior(i);
    }
    return theta;
  }
};

FreeParameters free_parameters(const RegressionOptions& options, const Eigen::MatrixXd& triangle,
                               const Eigen::MatrixXd& W) {
  const Eigen::Index n = W.rows() - 1;
  FreeParameters out;
  out.all_prior = options.prior.size() > 0 ? options.prior : Eigen::VectorXd::Zero(n).eval();
  out.all_weight = options.prior_weight.size() > 0 ? options.prior_weight : Eigen::VectorXd::Ones(n).eval();
  out.pinning = pin_parameters(out.all_prior, out.all_weight);
  const auto count = signed_index(out.pinning.free.size());
  out.prior.resize(count);
  out.weight.resize(count);
  for (Eigen::Index j = 0; j < count; ++j) {
    out.prior(j) = out.all_prior(out.pinning.free[j]);
    out.weight(j) = out.all_weight(out.pinning.free[j]);
  }
  const bool pinned = count < n;
  const Eigen::MatrixXd& P = out.pinning.P;
  out.triangle = pinned ? retriangulate(triangle * P) : triangle;
  out.error_covariance = pinned ? Eigen::MatrixXd(P.transpose() * W * P) : W;
  out.lift = P.topLeftCorner(n, count);
  return out;
}

/// What is assumed of directions that the data do not excite.
struct UnexcitedBound {
  Eigen::MatrixXd covariance;  ///< of the free parameters
  Eigen::VectorXd share;       ///< of each free parameter's unit vector
  std::vector<Direction> directions;
};

UnexcitedBound bound_unexcited(const PcaTotalLeastSquares& pca, const FreeParameters& free, double given_limit,
                               double rows, const std::vector<std::string>& names) {
  UnexcitedBound out;
  out.covariance = Eigen::MatrixXd::Zero(free.count(), free.count());
  out.share = Eigen::VectorXd::Zero(free.count());
  if (pca.unexcited.cols() == 0) return out;
  const Eigen::VectorXd offset = free.weight.cwiseProduct(pca.theta - free.prior);
  const double automatic = kAutomaticBound * std::max(1.0, offset.cwiseAbs().maxCoeff());
  const TotalLeastSquares full = total_least_squares(free.triangle, free.error_covariance, rows);
  for (Eigen::Index j = 0; j < pca.unexcited.cols(); ++j) {
    const Eigen::VectorXd direction = pca.unexcited.col(j);
    double limit = given_limit > 0.0 ? given_limit : automatic;
    if (full.solved) {
      const Eigen::VectorXd weighted = free.weight.cwiseProduct(direction);
      limit = std::max(limit,
                       numerics::kNormal95 * std::sqrt(std::max(0.0, weighted.dot(full.covariance_white * weighted))));
    }
    const Eigen::VectorXd q = direction.cwiseQuotient(free.weight);
    out.covariance += (limit / numerics::kNormal95) * (limit / numerics::kNormal95) * q * q.transpose();
    out.share += direction.cwiseAbs2();
    Eigen::VectorXd combination = free.lift * q;
    combination /= combination.norm();
    out.directions.push_back({combination, limit, describe_combination(combination, names)});
  }
  return out;
}

/// Variance inflation of each free parameter when what is not excited is held.
Eigen::VectorXd inflation_on_excited(const PcaTotalLeastSquares& pca, const FreeParameters& free,
                                     const Eigen::VectorXd& spread) {
  const Eigen::MatrixXd directions = free.weight.cwiseInverse().asDiagonal() * pca.excited;
  const Eigen::MatrixXd rows = free.triangle.leftCols(free.count()) * directions;
  const Eigen::MatrixXd inverse = directions * numerics::solve_symmetric(Eigen::MatrixXd(rows.transpose() * rows),
                                                                         Eigen::MatrixXd(directions.transpose()));
  return spread.cwiseProduct(inverse.diagonal()).cwiseMax(1.0);
}

std::string list_of(const std::vector<Direction>& directions) {
  std::string text;
  for (const Direction& d : directions) text += (text.empty() ? "" : "; ") + d.text;
  return text;
}

}  // namespace

RegressionAnalysis::RegressionAnalysis(const RegressionData& data, const RegressionOptions& options)
    : data_(data), options_(options) {
  data.validate();
  options.validate(data.parameters());
  if (data.row_scale.size() > 0) {
    scaled_X_ = data.row_scale.cwiseInverse().asDiagonal() * data.regressors;
    scaled_z_ = data.regressand.cwiseQuotient(data.row_scale);
  }
  segments_ = segment_ranges(data.rows(), data.segment);
  triangle_ = triangle_of(data);
  least_squares_ = ordinary_least_squares(triangle_);

  if (data.has_error_covariance()) {
    error_covariance_ = data.error_covariance;
    if (!data.regressand_error_known) {
      error_covariance_ = with_equation_error(triangle_, data.error_covariance, rows());
      ratio_ = ErrorRatio::kEstimated;
    }
  }

  const Eigen::Index n = data.parameters();
  const Eigen::RowVectorXd mean = data.regressors.colwise().mean();
  bool has_constant = false;
  for (Eigen::Index j = 0; j < n; ++j) {
    constant_.push_back((data.regressors.col(j).array() == data.regressors(0, j)).all());
    has_constant = has_constant || constant_.back();
  }
  spread_ = triangle_.leftCols(n).colwise().squaredNorm().transpose();
  if (has_constant && data.row_scale.size() == 0) spread_ -= rows() * mean.cwiseAbs2().transpose();
  variance_inflation_ = Eigen::VectorXd::Ones(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    if (constant_[j]) continue;
    variance_inflation_(j) =
        least_squares_.full_rank ? std::max(1.0, spread_(j) * least_squares_.inverse_normal(j, j)) : kInfinity;
  }
}

Eigen::MatrixXd RegressionAnalysis::error_covariance(Method method) const {
  const Eigen::Index size = data_.parameters() + 1;
  if (method != Method::kTls && data_.has_error_covariance()) return error_covariance_;
  Eigen::VectorXd noisy = Eigen::VectorXd::Zero(size);
  for (Eigen::Index j = 0; j + 1 < size; ++j) {
    const bool has_error = data_.has_error_covariance() ? data_.error_covariance(j, j) > 0.0 : !constant_[j];
    if (method == Method::kTls && has_error) noisy(j) = 1.0;
  }
  noisy(size - 1) = 1.0;
  return noisy.asDiagonal();
}

RegressionEstimate RegressionAnalysis::run(Method method) const {
  RegressionEstimate result;
  result.method = method;
  result.rows = X().rows();
  result.condition_number = least_squares_.condition_number;
  switch (method) {
    case Method::kOls:
      result = by_ols(std::move(result));
      break;
    case Method::kTls:
    case Method::kGtls:
      result = by_tls(std::move(result));
      break;
    case Method::kPcaGtls:
      result = by_pca(std::move(result));
      break;
  }
  result = with_intervals(std::move(result));
  return result;
}

RegressionEstimate RegressionAnalysis::by_ols(RegressionEstimate result) const {
  const OrdinaryLeastSquares& ols = least_squares_;
  const Eigen::Index n = data_.parameters();
  const double freedom = rows() - static_cast<double>(n);
  result.theta = ols.theta;
  result.singular_values.assign(ols.singular_values.data(), ols.singular_values.data() + n);
  result.excited_directions = n;
  result.degrees_of_freedom = freedom;
  if (!ols.full_rank) {
    result.termination = EstimateTermination::kRankDeficient;
    result.message = fmt::format("regressors are linearly dependent (condition number {:.2g}): no unique estimate",
                                 ols.condition_number);
    return result;
  }
  const double variance = ols.residual_sum_of_squares / freedom;
  if (data_.has_error_covariance() && data_.error_scale_known) {
    const Eigen::Index last = n;
    result.error_scale = variance / data_.error_covariance(last, last);
  }
  result.covariance_white = variance * ols.inverse_normal;
  result.covariance = result.covariance_white;
  if (options_.covariance == CovarianceKind::kAutocorrelated) {
    const Eigen::VectorXd r = residual(ols.theta);
    const Eigen::Index window = correlation_length(r, segments_, options_.max_lag);
    const LongRunCovariance filling = autocorrelated_normal_matrix(X(), r, segments_, window);
    result.covariance = rows() / freedom * (ols.inverse_normal * filling.matrix * ols.inverse_normal);
    result.degrees_of_freedom = std::min(freedom, filling.degrees_of_freedom);
    result.lag_window = window;
  }
  result.termination = EstimateTermination::kEstimated;
  result.message =
      fmt::format("estimated from {} rows, all error taken to be in {}", result.rows, data_.regressand_name);
  return result;
}

RegressionEstimate RegressionAnalysis::by_tls(RegressionEstimate result) const {
  const Eigen::Index n = data_.parameters();
  const double freedom = rows() - static_cast<double>(n);
  const Eigen::MatrixXd W = error_covariance(result.method);
  const ErrorRatio ratio = result.method == Method::kTls ? ErrorRatio::kKnown : ratio_;
  const TotalLeastSquares tls = total_least_squares(triangle_, W, rows(), ratio);
  result.theta = tls.theta;
  result.singular_values.assign(tls.singular_values.data(), tls.singular_values.data() + tls.singular_values.size());
  result.error_scale = tls.error_scale;
  result.excited_directions = n;
  result.degrees_of_freedom = freedom;
  if (!tls.full_rank) {
    result.termination = EstimateTermination::kRankDeficient;
    result.message = "exactly known regressors are linearly dependent: no unique estimate";
    return result;
  }
  if (!tls.solved) {
    result.termination = EstimateTermination::kNongeneric;
    result.message = fmt::format(
        "a combination of the regressors is as small as its assumed errors ({:.0f} % noise): no {} solution",
        100.0 * std::min(1.0, tls.noise_share), to_string(result.method));
    return result;
  }
  result.covariance_white = tls.covariance_white;
  result.covariance = tls.covariance_white;
  if (options_.covariance == CovarianceKind::kAutocorrelated) {
    const Scores scores = errors_in_variables_scores(X(), z(), W, tls.theta, ratio);
    const Eigen::Index window = correlation_length(scores.residual, segments_, options_.max_lag);
    const LongRunCovariance filling = score_covariance(scores, segments_, window);
    result.covariance = rows() / freedom * (tls.inverse_jacobian * filling.matrix * tls.inverse_jacobian);
    result.degrees_of_freedom = std::min(freedom, filling.degrees_of_freedom);
    result.lag_window = window;
  }
  result.termination = EstimateTermination::kEstimated;
  result.message =
      fmt::format("estimated from {} rows; noise is at most {:.2g} % of the power of any combination of regressors",
                  result.rows, 100.0 * tls.noise_share);
  return result;
}

std::optional<Eigen::VectorXd> RegressionAnalysis::theta_under(Method method, const Eigen::MatrixXd& W) const {
  if (method == Method::kGtls) {
    const TotalLeastSquares tls = total_least_squares(triangle_, W, rows());
    return tls.solved ? std::optional(tls.theta) : std::nullopt;
  }
  // GTLS within the directions that are excited under the assumed errors.
  const FreeParameters free = free_parameters(options_, triangle_, error_covariance(method));
  const Eigen::Index count = free.count();
  const PcaTotalLeastSquares pca =
      pca_total_least_squares(free.triangle, free.error_covariance, rows(), options_.signal_to_noise,
                              data_.error_scale_known, free.prior, free.weight);
  if (!pca.solved) return std::nullopt;
  const Eigen::MatrixXd directions = free.weight.cwiseInverse().asDiagonal() * pca.excited;
  Eigen::MatrixXd change = Eigen::MatrixXd::Zero(count + 1, directions.cols() + 1);
  change.topLeftCorner(count, directions.cols()) = directions;
  change.col(directions.cols()) << -free.prior, 1.0;
  const Eigen::MatrixXd P = free.pinning.P * change;
  const TotalLeastSquares tls =
      total_least_squares(retriangulate(triangle_ * P), Eigen::MatrixXd(P.transpose() * W * P), rows());
  if (!tls.solved) return std::nullopt;
  return free.all_values(free.prior + directions * tls.theta);
}

RegressionEstimate RegressionAnalysis::by_pca(RegressionEstimate result) const {
  const Eigen::Index n = data_.parameters();
  const double freedom = rows() - static_cast<double>(n);
  const FreeParameters free = free_parameters(options_, triangle_, error_covariance(result.method));
  const Eigen::MatrixXd& W = free.error_covariance;
  const bool scale_known = data_.has_error_covariance() && data_.error_scale_known;
  const PcaTotalLeastSquares pca =
      pca_total_least_squares(free.triangle, W, rows(), options_.signal_to_noise, scale_known, free.prior, free.weight);
  result.theta = free.all_values(pca.theta);
  result.singular_values.assign(pca.singular_values.data(), pca.singular_values.data() + pca.singular_values.size());
  result.threshold = pca.threshold;
  result.error_scale = pca.error_scale;
  result.excited_directions = pca.excited_directions;
  result.degrees_of_freedom = freedom;
  if (!pca.solved) {
    result.termination = EstimateTermination::kNongeneric;
    result.message = "no combination of the excited directions explains the regressand: no PCA-GTLS solution";
    return result;
  }

  const Eigen::MatrixXd& inverse = pca.inverse_on_excited;
  const Eigen::MatrixXd excited_white =
      inverse * white_score_covariance(pca.jacobian, W, pca.theta, pca.error_scale, rows(), ratio_) * inverse;
  Eigen::MatrixXd excited = excited_white;
  if (options_.covariance == CovarianceKind::kAutocorrelated) {
    // Of the free parameters; pinned ones are moved to the regressand.
    const Scores scores = free.count() < n ? errors_in_variables_scores(
                                                 X() * free.lift, z() + X() * free.pinning.P.col(free.count()).head(n),
                                                 W, pca.theta, ratio_)
                                           : errors_in_variables_scores(X(), z(), W, pca.theta, ratio_);
    const Eigen::Index window = correlation_length(scores.residual, segments_, options_.max_lag);
    const LongRunCovariance filling = score_covariance(scores, segments_, window);
    excited = rows() / freedom * (inverse * filling.matrix * inverse);
    result.degrees_of_freedom = std::min(freedom, filling.degrees_of_freedom);
    result.lag_window = window;
  }

  UnexcitedBound bound = bound_unexcited(pca, free, options_.unexcited_bound, rows(), data_.parameter_names);
  result.unexcited = std::move(bound.directions);
  result.covariance_white = free.lift * (excited_white + bound.covariance) * free.lift.transpose();
  result.covariance = free.lift * (excited + bound.covariance) * free.lift.transpose();
  result.termination = EstimateTermination::kEstimated;
  result.message = result.unexcited.empty()
                       ? fmt::format("all {} directions are excited", n)
                       : fmt::format("{} of {} directions are excited; not excited: {}", pca.excited_directions,
                                     free.count(), list_of(result.unexcited));
  // Kept here because `finish` cannot distinguish the bound from the excited part.
  const double critical = numerics::student_t_quantile(1.0 - 0.5 * options_.significance, result.degrees_of_freedom);
  result.parameters.resize(n);
  const Eigen::VectorXd inflation = inflation_on_excited(pca, free, free.lift.transpose() * spread_);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!std::isfinite(free.all_weight(i))) result.parameters[i].status = ParameterStatus::kFixed;
  }
  for (Eigen::Index j = 0; j < free.count(); ++j) {
    Parameter& p = result.parameters[free.pinning.free[j]];
    p.variance_inflation = inflation(j);
    p.unexcited_share = std::min(1.0, bound.share(j));
    const double by_bound = bound.covariance(j, j);
    const double sigma = std::sqrt(std::max(0.0, excited(j, j) + by_bound));
    const bool bound_dominates = by_bound > excited(j, j) && !(std::abs(pca.theta(j)) > critical * sigma);
    p.status = p.unexcited_share > 0.5 || bound_dominates ? ParameterStatus::kNotExcited : ParameterStatus::kIdentified;
  }
  return result;
}

RegressionEstimate RegressionAnalysis::with_intervals(RegressionEstimate result) const {
  const Eigen::Index n = data_.parameters();
  result.parameters.resize(n);
  const Eigen::VectorXd r = data_.regressand - data_.regressors * result.theta;
  const double spread = (data_.regressand.array() - data_.regressand.mean()).square().sum();
  result.residual_sd = std::sqrt(r.squaredNorm() / std::max(1.0, rows() - static_cast<double>(n)));
  result.r_squared = spread > 0.0 ? 1.0 - r.squaredNorm() / spread : 0.0;
  const Eigen::VectorXd scaled = data_.row_scale.size() > 0 ? Eigen::VectorXd(r.cwiseQuotient(data_.row_scale)) : r;
  const std::span<const double> view(scaled.data(), static_cast<std::size_t>(scaled.size()));
  result.whiteness = numerics::whiteness_test(view, 0, data_.segment);
  result.normal_plot = numerics::normal_probability_plot(view, options_.normal_plot_points);
  const bool usable = result.usable();
  const double freedom = std::max(1.0, result.degrees_of_freedom);
  for (Eigen::Index i = 0; i < n; ++i) {
    Parameter& p = result.parameters[i];
    p.name = data_.parameter_names[i];
    if (!data_.parameter_units.empty()) p.unit = data_.parameter_units[i];
    p.value = result.theta(i);
    if (result.unexcited.empty()) p.variance_inflation = variance_inflation_(i);
    if (!usable) {
      p.sigma = p.sigma_white = kInfinity;
      p.low95 = -p.sigma;
      p.high95 = p.sigma;
      p.status = ParameterStatus::kRejected;
      continue;
    }
    p.sigma = std::sqrt(std::max(0.0, result.covariance(i, i)));
    p.sigma_white = std::sqrt(std::max(0.0, result.covariance_white(i, i)));
    set_interval(p, freedom);
    if (p.status != ParameterStatus::kNotExcited && p.status != ParameterStatus::kFixed) {
      p.status = p.p_value < options_.significance ? ParameterStatus::kIdentified : ParameterStatus::kInsignificant;
    }
  }
  if (!usable) {
    result.covariance = result.covariance_white = Eigen::MatrixXd::Constant(n, n, kInfinity);
  }
  return result;
}

}  // namespace veridyn::estimation::internal
