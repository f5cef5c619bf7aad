#include "veridyn/estimation/regression/long_run_covariance.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/numerics/filters.hpp"
#include "veridyn/numerics/linear_algebra/products.hpp"
#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"

namespace veridyn::estimation {
namespace {

double lagged(const Eigen::Ref<const Eigen::VectorXd>& x, const SegmentRanges& segments, Eigen::Index lag) {
  double sum = 0.0;
  for (const auto& [begin, end] : segments) {
    const Eigen::Index count = end - begin - lag;
    if (count > 0) sum += x.segment(begin, count).dot(x.segment(begin + lag, count));
  }
  return sum;
}

// sum over |lag| < width of (1 - |lag|/width) g_k g_{k+lag}': the outer products of all sums over `width` neighbours,
// ends padded with zeros, over width.
Eigen::MatrixXd bartlett(const RowMatrix& g, const SegmentRanges& segments, Eigen::Index width) {
  const Eigen::Index n = g.cols();
  constexpr Eigen::Index kBatch = 256;
  Eigen::MatrixXd total = Eigen::MatrixXd::Zero(n, n);
  RowMatrix sums(kBatch, n);
  for (const auto& [begin, end] : segments) {
    Eigen::RowVectorXd running = Eigen::RowVectorXd::Zero(n);
    Eigen::Index filled = 0;
    for (Eigen::Index k = begin; k < end + width - 1; ++k) {
      if (k < end) running += g.row(k);
      if (k - width >= begin) running -= g.row(k - width);
      sums.row(filled++) = running;
      if (filled == kBatch || k + 1 == end + width - 1) {
        total.noalias() += sums.topRows(filled).transpose() * sums.topRows(filled);
        filled = 0;
      }
    }
  }
  return total / static_cast<double>(width);
}

// Share of a zero-sum sequence's long-run variance that the lag window still covers, and the window's degrees of
// freedom.
void set_reliability(LongRunCovariance& result, double rows, Eigen::Index window) {
  double sum = 1.0, squares = 1.0;
  for (Eigen::Index lag = 1; lag < 2 * window; ++lag) {
    const double w = flat_top_weight(lag, window);
    sum += 2.0 * w;
    squares += 2.0 * w * w;
  }
  const double kept = std::max(0.2, 1.0 - sum / rows);
  result.matrix /= kept;
  result.window = window;
  result.degrees_of_freedom = std::max(1.0, rows / squares);
}

// Raises directions of `matrix` that are below `floor` times `reference`.
Eigen::MatrixXd raised_to(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& reference, double floor) {
  Eigen::VectorXd scale = reference.diagonal().cwiseMax(0.0).cwiseSqrt();
  for (double& s : scale) s = s > 0.0 ? s : 1.0;
  const Eigen::VectorXd inverse_scale = scale.cwiseInverse();
  const numerics::SymmetricEigen basis =
      numerics::symmetric_eigen(numerics::scaled(inverse_scale, reference, inverse_scale));
  const Eigen::VectorXd root = basis.values.cwiseMax(1e-14).cwiseSqrt();
  const Eigen::MatrixXd back = numerics::scaled(scale, basis.vectors, root);
  const Eigen::MatrixXd forth = numerics::scaled(root.cwiseInverse(), basis.vectors.transpose(), inverse_scale);
  const Eigen::MatrixXd relative = numerics::product_transposed(numerics::product(forth, matrix), forth);
  const numerics::SymmetricEigen ratio = numerics::symmetric_eigen(0.5 * (relative + relative.transpose()));
  return numerics::from_eigen(numerics::product(back, ratio.vectors), ratio.values.cwiseMax(floor));
}

}  // namespace

double flat_top_weight(Eigen::Index lag, Eigen::Index window) {
  if (lag <= window) return 1.0;
  return std::max(0.0, 2.0 - static_cast<double>(lag) / static_cast<double>(window));
}

Eigen::Index correlation_length(const Eigen::Ref<const Eigen::VectorXd>& x, const SegmentRanges& segments,
                                Eigen::Index max_lag) {
  const auto N = static_cast<double>(x.size());
  const double power = lagged(x, segments, 0);
  if (x.size() < 20 || !(power > 0.0)) return 0;
  const double band = 2.0 * std::sqrt(std::log10(N) / N);
  const Eigen::Index quiet_needed =
      std::max<Eigen::Index>(5, static_cast<Eigen::Index>(std::ceil(std::sqrt(std::log10(N)))));
  const Eigen::Index limit = std::min(max_lag, x.size() / 8);
  Eigen::Index last_loud = 0;
  for (Eigen::Index lag = 1; lag <= limit && lag - last_loud <= quiet_needed; ++lag) {
    if (std::abs(lagged(x, segments, lag) / power) > band) last_loud = lag;
  }
  return last_loud;
}

LongRunCovariance long_run_covariance(const RowMatrix& scores, const SegmentRanges& segments, Eigen::Index window) {
  LongRunCovariance result;
  if (window < 1) {
    result.matrix = scores.transpose() * scores;
  } else {
    const Eigen::MatrixXd narrow = bartlett(scores, segments, window);
    const Eigen::MatrixXd wide = bartlett(scores, segments, 2 * window);
    result.matrix = raised_to(2.0 * wide - narrow, wide, 0.25);
  }
  set_reliability(result, static_cast<double>(scores.rows()), window);
  return result;
}

LongRunCovariance autocorrelated_normal_matrix(const RowMatrix& regressors,
                                               const Eigen::Ref<const Eigen::VectorXd>& residual,
                                               const SegmentRanges& segments, Eigen::Index window) {
  const Eigen::Index n = regressors.cols();
  const auto N = static_cast<double>(regressors.rows());
  LongRunCovariance result;
  const double power = lagged(residual, segments, 0) / N;
  result.matrix = power * (regressors.transpose() * regressors);
  const Eigen::MatrixXd white = result.matrix;
  // X'(Gamma X) with Gamma the banded Toeplitz matrix of lag-window times autocovariance: a filter along every column.
  if (window > 0) {
    numerics::FirKernel kernel;
    kernel.taps.assign(static_cast<std::size_t>(4 * window - 1), 0.0);
    const auto m = static_cast<std::size_t>(2 * window - 1);
    for (Eigen::Index lag = 1; lag < 2 * window; ++lag) {
      const double weight = flat_top_weight(lag, window) * lagged(residual, segments, lag) / N;
      kernel.taps[m + static_cast<std::size_t>(lag)] = kernel.taps[m - static_cast<std::size_t>(lag)] = weight;
    }
    std::vector<double> padded, filtered;
    for (const auto& [begin, end] : segments) {
      const auto count = static_cast<std::size_t>(end - begin);
      padded.assign(count + 2 * m, 0.0);
      filtered.resize(padded.size());
      for (Eigen::Index j = 0; j < n; ++j) {
        Eigen::Map<Eigen::VectorXd>(padded.data() + m, end - begin) = regressors.col(j).segment(begin, end - begin);
        numerics::filter(padded, kernel, filtered, numerics::Edges::kNan);
        const Eigen::Map<const Eigen::VectorXd> column(filtered.data() + m, end - begin);
        result.matrix.col(j).noalias() += regressors.middleRows(begin, end - begin).transpose() * column;
      }
    }
    result.matrix = (0.5 * (result.matrix + result.matrix.transpose())).eval();
  }
  // A lag window can turn a direction's variance negative; residuals that alternate may lower it, but not to nothing.
  if (window > 0) result.matrix = raised_to(result.matrix, white, 0.05);
  set_reliability(result, N, window);
  return result;
}

RowMatrix Scores::rows() const {
  RowMatrix rows = residual.asDiagonal() * regressors;
  if (quadratic.squaredNorm() > 0.0) {
    const double mean_square = residual.squaredNorm() / static_cast<double>(residual.size());
    rows += (residual.array().square() / mean_square - 1.0).matrix() * quadratic.transpose();
  }
  return rows;
}

LongRunCovariance score_covariance(const Scores& scores, const SegmentRanges& segments, Eigen::Index window) {
  LongRunCovariance result = autocorrelated_normal_matrix(scores.regressors, scores.residual, segments, window);
  if (scores.quadratic.squaredNorm() > 0.0) {
    const double power = lagged(scores.residual, segments, 0);
    double sum = 1.0;
    for (Eigen::Index lag = 1; lag < 2 * window; ++lag) {
      const double correlation = lagged(scores.residual, segments, lag) / power;
      sum += 2.0 * flat_top_weight(lag, window) * correlation * correlation;
    }
    const auto N = static_cast<double>(scores.residual.size());
    result.matrix += 2.0 * N * sum * scores.quadratic * scores.quadratic.transpose();
  }
  const LongRunCovariance sandwich = long_run_covariance(scores.rows(), segments, window);
  // A variance from n degrees of freedom has a standard error of sqrt(2/n) of it.
  const double surely = 1.0 / (1.0 + std::sqrt(2.0 / sandwich.degrees_of_freedom));
  result.matrix = raised_to(result.matrix, sandwich.matrix, surely);
  return result;
}

}  // namespace veridyn::estimation
