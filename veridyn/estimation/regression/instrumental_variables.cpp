#include "veridyn/estimation/regression/instrumental_variables.hpp"

#include <algorithm>

#include "veridyn/core/assert.hpp"
#include "veridyn/estimation/regression/long_run_covariance.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/numerics/linear_algebra/orthogonal.hpp"

namespace veridyn::estimation {

InstrumentalEstimate instrumental_variables(const RegressionData& data, const RowMatrix& instruments,
                                            Eigen::Index max_lag) {
  VERIDYN_ASSERT(instruments.rows() == data.rows());
  VERIDYN_ASSERT(instruments.cols() >= data.parameters());
  InstrumentalEstimate out;
  const Eigen::Index n = data.parameters();
  if (data.rows() < 10 * instruments.cols()) return out;
  const Eigen::MatrixXd Q = numerics::HouseholderQr(Eigen::MatrixXd(instruments)).Q().leftCols(instruments.cols());
  const RowMatrix projected = Q * (Q.transpose() * data.regressors);
  const Eigen::MatrixXd normal = projected.transpose() * data.regressors;
  const numerics::PivotedCholesky factor(normal);
  const double scale = normal.diagonal().maxCoeff();
  if (!(factor.smallest_pivot() > 1e-10 * scale)) return out;
  out.theta = factor.solve(Eigen::VectorXd(projected.transpose() * data.regressand));
  const Eigen::VectorXd residual = data.regressand - data.regressors * out.theta;
  const RowMatrix scores = residual.asDiagonal() * projected;
  const SegmentRanges segments = segment_ranges(data.rows(), data.segment);
  const Eigen::Index window = correlation_length(residual, segments, std::min(max_lag, data.rows() / 4));
  const LongRunCovariance filling = long_run_covariance(scores, segments, window);
  const Eigen::MatrixXd half = factor.solve(filling.matrix);
  out.covariance = factor.solve(Eigen::MatrixXd(half.transpose()));
  out.usable = out.theta.allFinite() && out.covariance.allFinite() && out.covariance.diagonal().minCoeff() >= 0.0 &&
               out.theta.size() == n;
  return out;
}

}  // namespace veridyn::estimation
