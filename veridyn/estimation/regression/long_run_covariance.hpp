#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "veridyn/estimation/regression/regression_data.hpp"

namespace veridyn::estimation {

/// Covariance of a sum of correlated terms, S = Cov(sum_k g_k), and how well it is known.
struct LongRunCovariance {
  Eigen::MatrixXd matrix;
  Eigen::Index window = 0;          ///< lags that count in full [samples]
  double degrees_of_freedom = 0.0;  ///< of S as an estimate: terms over the sum of squared lag weights
};

/// Rows [first, second) of each segment.
using SegmentRanges = std::vector<std::pair<Eigen::Index, Eigen::Index>>;

/// Lag after which a sequence is not distinguishably correlated: the smallest m such that |r(m+1..m+K)| all stay below
/// 2 sqrt(log10 N / N), K = max(5, sqrt(log10 N)) (Politis 2003); 0 for a white one.
[[nodiscard]] Eigen::Index correlation_length(const Eigen::Ref<const Eigen::VectorXd>& x, const SegmentRanges& segments,
                                              Eigen::Index max_lag);

/// Weight of a lag, not negative, in a flat-top window: 1 up to `window`, from there straight to 0 at twice that.
[[nodiscard]] double flat_top_weight(Eigen::Index lag, Eigen::Index window);

/// Sandwich filling of an estimator with scores g_k (rows of `scores`), lags weighted by `flat_top_weight`
/// (no bias from correlation shorter than `window`, unlike Bartlett's).
/// Computed as 2 B(2w) - B(w) of Bartlett sums, each by running sums over the window: cost N n^2 whatever the window.
/// Directions whose variance comes out below a quarter of Bartlett's are raised to it, so the result is positive
/// semi-definite. Lags stay within segments. Since scores of an estimate sum to zero, S is divided by 1 -
/// sum(weights)/N, the share they lost by that.
[[nodiscard]] LongRunCovariance long_run_covariance(const RowMatrix& scores, const SegmentRanges& segments,
                                                    Eigen::Index window);

/// Morelli & Klein (1997): sum over i, j of x_i R(i - j) x_j', with R the autocovariance of the
/// residual under the same lag window. Needs the residual independent of X; steadier than the sandwich since R is one
/// function.
[[nodiscard]] LongRunCovariance autocorrelated_normal_matrix(const RowMatrix& regressors,
                                                             const Eigen::Ref<const Eigen::VectorXd>& residual,
                                                             const SegmentRanges& segments, Eigen::Index window);

/// Scores g_k = x_k r_k + q (r_k^2/s2 - 1) of an estimating equation, s2 the mean square of the residual r; regressors
/// x are independent of r, q is zero for least squares.
struct Scores {
  RowMatrix regressors;
  Eigen::VectorXd residual;
  Eigen::VectorXd quadratic;

  /// g_k, in rows.
  [[nodiscard]] RowMatrix rows() const;
};

/// Covariance of their sum from the autocorrelation of the residual (`autocorrelated_normal_matrix`; for a Gaussian one
/// Cov(r_i^2, r_j^2) = 2 R(i - j)^2), raised in directions where the scores' own `long_run_covariance` is larger by
/// more than its standard error. The first is one function of the lag, which 400 rows determine well enough; the second
/// holds too where the residual is larger in manoeuvres, but 400 correlated rows give intervals of 95 % that hold the
/// truth in 89 to 93 %.
[[nodiscard]] LongRunCovariance score_covariance(const Scores& scores, const SegmentRanges& segments,
                                                 Eigen::Index window);

}  // namespace veridyn::estimation
