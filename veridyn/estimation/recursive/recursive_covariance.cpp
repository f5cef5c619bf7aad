// Error bars of RecursiveRegression: computed at the first call after an update.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/recursive/recursive_state.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"
#include "veridyn/numerics/linear_algebra/singular_values.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::estimation {
namespace {

constexpr double kAutomaticBound = 10.0;

// A S A for symmetric A and S. Plain loops: for these sizes a third of the time of general products.
SmallMatrix sandwich(const SmallMatrix& A, const SmallMatrix& S) {
  const Eigen::Index n = A.rows();
  SmallMatrix half(n, n), result(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    std::array<double, kMaxRecursiveColumns> column{};
    for (Eigen::Index k = 0; k < n; ++k) {
      const double a = A(k, j);
      const double* s = S.data() + k * n;
      for (Eigen::Index i = 0; i < n; ++i) column[i] += a * s[i];
    }
    for (Eigen::Index i = 0; i < n; ++i) half(i, j) = column[i];
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = 0; i <= j; ++i) {
      const double *a = A.data() + i * n, *b = half.data() + j * n;
      double sum = 0.0;
      for (Eigen::Index k = 0; k < n; ++k) sum += a[k] * b[k];
      result(i, j) = result(j, i) = sum;
    }
  }
  return result;
}

}  // namespace

// M^-1 = sum_j p_j p_j'/(s_j^2 - s_min^2) + sum_i p_i p_i' over exact i, with p = b_x + theta b_z the part of b that is
// a change of theta: since (D'D - s_min^2 W) h = 0 for h of s_min, these are orthogonal in M (docs/estimation.md).
bool RecursiveRegression::State::inverse_jacobian(const SmallVector& least, SmallMatrix& inverse) const {
  const Eigen::Index n = count();
  const int last = data.noisy_columns() - 1;
  const double smallest = data.singular_value(last);
  SmallVector b(n + 1), p(n);
  inverse.setZero(n, n);
  for (int j = 0; j < last + data.exact_rank(); ++j) {
    double factor = 1.0;
    if (j < last) {
      const double s = data.singular_value(j);
      if (!(s > smallest)) return false;
      factor = 1.0 / std::sqrt((s - smallest) * (s + smallest));
      data.basis(j, b.data());
    } else {
      data.exact_basis(j - last, b.data());
    }
    for (Eigen::Index i = 0; i < n; ++i) p(i) = factor * (b(i) + least(i) * b(n));
    for (Eigen::Index k = 0; k < n; ++k) {
      for (Eigen::Index i = 0; i <= k; ++i) inverse(i, k) += p(i) * p(k);
    }
  }
  for (Eigen::Index k = 0; k < n; ++k) {
    for (Eigen::Index i = 0; i < k; ++i) inverse(k, i) = inverse(i, k);
  }
  return true;
}

// M = X'X - s_min^2 W_xx.
void RecursiveRegression::State::corrected_jacobian(SmallMatrix& M) const {
  const Eigen::Index n = count();
  SmallMatrix A;
  data.square_root(A);
  const double smallest = data.singular_value(data.noisy_columns() - 1);
  const SmallMatrix X = A.leftCols(n);
  M = X.transpose().lazyProduct(X);
  M -= (smallest * smallest) * W.topLeftCorner(n, n);
}

// Variance of the weighted sum of scores when errors are white: s2 A2 + (second-order term), see docs/estimation.md.
void RecursiveRegression::State::white_filling(const SmallMatrix& jacobian, const SmallVector& least_W_h, double s2,
                                               SmallMatrix& S) const {
  const Eigen::Index n = count();
  if (forgets) {
    const double kappa = squared_weights / samples;
    S.resize(n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
      for (Eigen::Index i = 0; i < n; ++i) {
        S(i, j) = s2 * squares(std::min(i, j), std::max(i, j)) + s2 * scale * static_cast<double>(n) * kappa * W(i, j) -
                  squared_weights * scale * scale * least_W_h(i) * least_W_h(j);
      }
    }
    return;
  }
  S = s2 * jacobian;
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = 0; i < n; ++i)
      S(i, j) += samples * (s2 * scale * W(i, j) - scale * scale * least_W_h(i) * least_W_h(j));
  }
}

// U^-1 E (E' U^-1 M U^-1 E)^-1 E' U^-1 with E orthonormal, orthogonal to `unexcited`.
void RecursiveRegression::State::inverse_on_excited(const SmallMatrix& jacobian, SmallMatrix& inverse) const {
  const Eigen::Index n = count(), k = n - unexcited.cols();
  inverse.setZero(n, n);
  if (k == 0) return;
  const Eigen::HouseholderQR<SmallMatrix> qr(unexcited);
  SmallMatrix Q = SmallMatrix::Identity(n, n);
  Q.applyOnTheLeft(qr.householderQ());
  SmallMatrix E = Q.rightCols(k);
  for (Eigen::Index i = 0; i < n; ++i) E.row(i) /= free_weight(i);
  const SmallMatrix half = jacobian.lazyProduct(E);
  SmallMatrix inner = E.transpose().lazyProduct(half);
  SmallVector inverse_scale(k);
  for (Eigen::Index i = 0; i < k; ++i) {
    if (!(inner(i, i) > 0.0)) return;
    inverse_scale(i) = 1.0 / std::sqrt(inner(i, i));
  }
  for (Eigen::Index j = 0; j < k; ++j) {
    for (Eigen::Index i = 0; i < k; ++i) inner(i, j) *= inverse_scale(i) * inverse_scale(j);
    E.col(j) *= inverse_scale(j);
  }
  const Eigen::LLT<SmallMatrix> cholesky(inner);
  if (cholesky.info() != Eigen::Success) return;
  SmallMatrix root = E.transpose();
  cholesky.matrixL().solveInPlace(root);
  inverse = root.transpose().lazyProduct(root);
}

// Adds the bound on what is not excited to `bound`: the limit in each direction, and at least the error bar that GTLS
// over all directions has there.
void RecursiveRegression::State::add_unexcited_bound(const SmallMatrix& jacobian, SmallMatrix& bound) const {
  const Eigen::Index n = count();
  double largest = 1.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    largest = std::max(largest, std::abs(free_weight(i) * (free_theta(i) - prior(free[i]))));
  }
  const double least = options.unexcited_bound > 0.0 ? options.unexcited_bound : kAutomaticBound * largest;
  // GTLS over all directions, where there is one: its error bar is a lower limit of the bound.
  SmallVector b(n + 1), gtls_h(n + 1), gtls_W_h;
  SmallMatrix gtls;
  bool has_gtls = data.null_columns() == 0;
  if (has_gtls) {
    data.basis(data.noisy_columns() - 1, b.data());
    has_gtls = data.share_of_last(b.data()) > 1e-20;
  }
  if (has_gtls) {
    gtls_h = b * (-1.0 / b(n));
    gtls_W_h = W.lazyProduct(gtls_h);
    SmallMatrix gtls_inverse, S;
    has_gtls = inverse_jacobian(gtls_h, gtls_inverse);
    if (has_gtls) {
      white_filling(jacobian, gtls_W_h, scale * gtls_h.dot(gtls_W_h), S);
      gtls = sandwich(gtls_inverse, S);
    }
  }
  for (Eigen::Index j = 0; j < unexcited.cols(); ++j) {
    double limit = least;
    if (has_gtls) {
      const SmallVector weighted = free_weight.cwiseProduct(unexcited.col(j));
      const SmallVector product = gtls.lazyProduct(weighted);
      const double variance = weighted.dot(product);
      if (variance > 0.0 && std::isfinite(variance)) limit = std::max(limit, numerics::kNormal95 * std::sqrt(variance));
    }
    const SmallVector q = unexcited.col(j).cwiseQuotient(free_weight) * (limit / numerics::kNormal95);
    bound += q.lazyProduct(q.transpose());
  }
}

// Factor on the variances for correlation that is longer than a block: those from blocks of L and of k L rows fall
// short by b/L and b/(k L), so that V = V_kL + (V_kL - V_L)/(k - 1). Pooled over the parameters; 1 while too few are
// closed.
double RecursiveRegression::State::long_correlation(const SmallMatrix& inverse) const {
  if (!(scores.wide_weight() > 0.0)) return 1.0;
  const SmallMatrix narrow = sandwich(inverse, scores.sum()), wide = sandwich(inverse, scores.wide_sum());
  double sum = 0.0, number = 0.0;
  for (Eigen::Index i = 0; i < inverse.rows(); ++i) {
    if (!(narrow(i, i) > 0.0)) continue;
    sum += wide(i, i) / narrow(i, i) * scores.weight() / scores.wide_weight();
    number += 1.0;
  }
  if (number == 0.0) return 1.0;
  const double ratio = sum / number;
  return std::max(1.0, ratio + (ratio - 1.0) / (internal::ScoreBlocks::kWide - 1.0));
}

void RecursiveRegression::State::compute_error_bars(CovarianceKind kind, internal::RecursiveErrorBars& result) const {
  const auto all = signed_index(names.size());
  const Eigen::Index n = count();
  result.covariance.setZero(all, all);
  result.sigma.setZero(all);
  result.excited_variance.setZero(all);
  result.degrees_of_freedom = std::max(1.0, samples - static_cast<double>(n));
  result.freedom.setConstant(all, result.degrees_of_freedom);
  bool good = termination == EstimateTermination::kEstimated && residual_variance >= 0.0;
  SmallMatrix inverse, jacobian, excited, bound;
  if (good) {
    const bool partial = unexcited.cols() > 0;
    if (partial) {
      corrected_jacobian(jacobian);
      inverse_on_excited(jacobian, inverse);
    } else {
      good = inverse_jacobian(h, inverse);
    }
    if (good) {
      // With all directions excited and nothing forgotten the leading term s2 M needs no M: M^-1 M M^-1 = M^-1.
      SmallMatrix S;
      double leading = 0.0;
      if (!partial && !forgets) {
        leading = residual_variance;
        jacobian.setZero(n, n);
      }
      white_filling(jacobian, W_h, residual_variance, S);
      if (kind == CovarianceKind::kAutocorrelated && scores.weight() > 0.0) {
        // Few blocks know little: the white filling counts as one of them.
        const double blocks = scores.blocks();
        const double trust = blocks / (blocks + 1.0);
        const double freedom = result.degrees_of_freedom;
        const double whole = squared_weights / scores.weight() * (samples > freedom ? samples / freedom : 1.0);
        S = (1.0 - trust) * S + (trust * whole * long_correlation(inverse)) * scores.sum();
        leading *= 1.0 - trust;
        for (Eigen::Index j = 0; j < n; ++j) {
          double& of_one = result.freedom(free[j]);
          of_one = std::min(freedom, std::max(1.0, scores.blocks_behind(inverse.col(j).data())));
          result.degrees_of_freedom = std::min(result.degrees_of_freedom, of_one);
        }
      }
      excited = sandwich(inverse, S);
      if (leading > 0.0) excited += leading * inverse;
    }
    bound.setZero(n, n);
    if (good && partial) add_unexcited_bound(jacobian, bound);
  }
  if (good) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const Eigen::Index to = free[j];
      for (Eigen::Index i = 0; i < n; ++i) {
        const Eigen::Index from = free[i];
        result.covariance(from, to) = excited(i, j) + bound(i, j);
      }
      good = good && std::isfinite(result.covariance(to, to));
      result.excited_variance(to) = std::max(0.0, excited(j, j));
      result.sigma(to) = std::sqrt(std::max(0.0, result.covariance(to, to)));
    }
  }
  if (good) return;
  result.covariance.setZero();
  result.sigma.setZero();
  for (const Eigen::Index i : free) {
    result.covariance(i, i) = result.sigma(i) = kInfinity;
    result.excited_variance(i) = kInfinity;
  }
}

const internal::RecursiveErrorBars& RecursiveRegression::State::error_bars(CovarianceKind kind) const {
  internal::RecursiveErrorBars& known = kind == CovarianceKind::kWhite ? white_bars : autocorrelated_bars;
  if (!known.fresh) {
    compute_error_bars(kind, known);
    known.fresh = true;
  }
  return known;
}

ParameterStatus RecursiveRegression::State::status(Eigen::Index parameter, double significance) const {
  if (std::find(pinned.begin(), pinned.end(), parameter) != pinned.end()) return ParameterStatus::kFixed;
  const internal::RecursiveErrorBars& known = error_bars(options.covariance);
  const double sigma = known.sigma(parameter);
  if (termination != EstimateTermination::kEstimated || !std::isfinite(sigma)) return ParameterStatus::kRejected;
  const double critical =
      numerics::student_t_quantile(1.0 - 0.5 * significance, std::max(1.0, known.freedom(parameter)));
  const bool differs = std::abs(theta(parameter)) > critical * sigma;
  const double bound = sigma * sigma - known.excited_variance(parameter);
  if (unexcited_share(parameter) > 0.5 || (bound > known.excited_variance(parameter) && !differs))
    return ParameterStatus::kNotExcited;
  return differs ? ParameterStatus::kIdentified : ParameterStatus::kInsignificant;
}

// Condition number and variance inflation 1/(1 - R^2) of the weighted rows, from X'X with columns of unit length. Where
// a column is constant the others' variance is that about their means, and its own inflation says nothing.
void RecursiveRegression::State::add_collinearity(RegressionEstimate& result) const {
  constexpr double kConstant = 1e-3;
  const Eigen::Index n = count();
  SmallMatrix A;
  data.square_root(A);
  const Eigen::MatrixXd X = A.leftCols(n);
  const Eigen::VectorXd length = X.colwise().norm().transpose();
  result.condition_number = kInfinity;
  if (!(length.minCoeff() > 0.0)) return;
  const Eigen::MatrixXd scaled = X * length.cwiseInverse().asDiagonal();
  const Eigen::VectorXd s = numerics::singular_values(scaled, numerics::SingularVectors::kNone).values;
  if (s(n - 1) > 0.0) result.condition_number = s(0) / s(n - 1);
  if (n < 2) return;
  // Share of each column's squares that is variance about its mean.
  Eigen::VectorXd spread = Eigen::VectorXd::Ones(n);
  for (Eigen::Index j = 0; j < n; ++j)
    if (column_squares(j) > 0.0)
      spread(j) = 1.0 - column_sums(j) * column_sums(j) / (column_weight * column_squares(j));
  const bool has_constant = spread.minCoeff() < kConstant;
  for (Eigen::Index j = 0; j < n; ++j) {
    if (spread(j) < kConstant) continue;
    Eigen::MatrixXd others(scaled.rows(), n - 1);
    others << scaled.leftCols(j), scaled.rightCols(n - 1 - j);
    const Eigen::VectorXd column = scaled.col(j);
    const double left = (column - others * numerics::shortest_least_squares(others, column)).squaredNorm();
    const double all = has_constant ? spread(j) : 1.0;
    result.parameters[free[j]].variance_inflation = left > 0.0 ? std::max(1.0, all / left) : kInfinity;
  }
}

RegressionEstimate RecursiveRegression::State::estimate(double significance) const {
  const internal::RecursiveErrorBars& known = error_bars(options.covariance);
  const auto all = signed_index(names.size());
  RegressionEstimate result;
  result.method = options.method;
  result.termination = termination;
  result.theta = theta;
  result.covariance = known.covariance;
  const internal::RecursiveErrorBars& white = error_bars(CovarianceKind::kWhite);
  result.covariance_white = white.covariance;
  result.degrees_of_freedom = known.degrees_of_freedom;
  result.lag_window = options.covariance == CovarianceKind::kAutocorrelated ? options.block : 0;
  result.rows = static_cast<Eigen::Index>(rows);
  result.residual_sd = residual_variance > 0.0 ? std::sqrt(residual_variance) : 0.0;
  result.error_scale = options.method == Method::kOls ? 0.0 : scale;
  result.singular_values.assign(singular_values.data(), singular_values.data() + singular_values.size());
  result.threshold = options.method == Method::kPcaGtls ? threshold : 0.0;
  result.excited_directions = excited_directions;
  for (Eigen::Index i = 0; i < all; ++i) {
    Parameter p;
    p.name = names[i];
    p.value = theta(i);
    p.sigma = known.sigma(i);
    p.sigma_white = white.sigma(i);
    p.status = status(i, significance);
    set_interval(p, std::max(1.0, known.freedom(i)));
    p.unexcited_share = unexcited_share(i);
    result.parameters.push_back(p);
  }
  for (Eigen::Index j = 0; j < unexcited_combinations.cols(); ++j) {
    const Eigen::VectorXd combination = unexcited_combinations.col(j);
    const double variance = combination.dot(result.covariance * combination);
    result.unexcited.push_back({combination, numerics::kNormal95 * std::sqrt(std::max(0.0, variance)),
                                describe_combination(combination, names)});
  }
  add_collinearity(result);
  switch (termination) {
    case EstimateTermination::kEstimated:
      result.message = result.unexcited.empty() ? fmt::format("estimated from {} rows, {:.0f} in effect", rows, samples)
                                                : fmt::format("{} of {} directions are excited; the others are held",
                                                              excited_directions, all - signed_index(pinned.size()));
      break;
    case EstimateTermination::kTooFewRows:
      result.message = fmt::format("{} rows for {} parameters", rows, all);
      break;
    case EstimateTermination::kRankDeficient:
      result.message = "exactly known regressors are linearly dependent: no unique estimate";
      break;
    case EstimateTermination::kNongeneric:
      result.message = "the data do not determine the parameters: the last estimate is held";
      break;
  }
  return result;
}

}  // namespace veridyn::estimation
