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

/// Sandwich filling of an estimator with scores g_k (rows of `scores`), lag weights 1 up to `window` and falling
/// straight to 0 at twice that (flat-top window: no bias from correlation shorter than `window`, unlike Bartlett's).
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

}  // namespace veridyn::estimation
