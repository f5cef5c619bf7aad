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
  const numerics::HouseholderQr qr{Eigen::MatrixXd(instruments)};
  const Eigen::VectorXd pivots = qr.R().diagonal().cwiseAbs();
  if (!(pivots.minCoeff() > 1e-10 * pivots.maxCoeff())) return out;
  const Eigen::MatrixXd Q = qr.thin_Q();
  const RowMatrix projected = Q * (Q.transpose() * data.regressors);
  const auto rows = static_cast<double>(data.rows());
  const Eigen::RowVectorXd mean = data.regressors.colwise().mean();
  const Eigen::VectorXd constant = rows * mean.transpose().cwiseAbs2();
  const Eigen::VectorXd explained = projected.colwise().squaredNorm().transpose() - constant;
  const Eigen::VectorXd total = data.regressors.colwise().squaredNorm().transpose() - constant;
  out.relevance = (total.array() > 1e-12 * constant.array()).select(explained.array() / total.array(), 0.0);
  const Eigen::MatrixXd normal = projected.transpose() * data.regressors;
  const numerics::PivotedCholesky factor(normal);
  const double scale = normal.diagonal().maxCoeff();
  if (!(factor.smallest_pivot() > 1e-10 * scale)) return out;
  out.theta = factor.solve(Eigen::VectorXd(projected.transpose() * data.regressand));
  const Eigen::VectorXd residual = data.regressand - data.regressors * out.theta;
  const RowMatrix scores = residual.asDiagonal() * projected;
  const SegmentRanges segments = segment_ranges(data.rows(), data.segment);
  const Eigen::Index longest = std::min(max_lag, data.rows() / 4);
  // Regressors that turn over (headings) hide the residual's own correlation length: all lags that may matter count.
  const Eigen::Index window = std::max(correlation_length(residual, segments, longest), longest / 2);
  const LongRunCovariance filling = long_run_covariance(scores, segments, window);
  out.degrees_of_freedom = filling.degrees_of_freedom;
  const Eigen::MatrixXd half = factor.solve(filling.matrix);
  out.covariance = factor.solve(Eigen::MatrixXd(half.transpose()));
  out.usable = out.theta.allFinite() && out.covariance.allFinite() && out.covariance.diagonal().minCoeff() >= 0.0 &&
               out.theta.size() == n;
  return out;
}

}  // namespace veridyn::estimation
