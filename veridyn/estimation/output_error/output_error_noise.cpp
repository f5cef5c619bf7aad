// The outputs' noise covariance R of a problem: where it starts, its maximum-likelihood update from residuals, with
// missing ones replaced by their expectation, and the likelihood under it.

#include <algorithm>
#include <cmath>
#include <vector>

#include "veridyn/estimation/output_error/output_error_problem.hpp"
#include "veridyn/numerics/linear_algebra/cholesky.hpp"
#include "veridyn/numerics/linear_algebra/products.hpp"
#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"

namespace veridyn::estimation::internal {

using Eigen::Index;

void OutputErrorProblem::set_noise(const Eigen::MatrixXd& noise) {
  noise_ = noise;
  for (Index j = 0; j < outputs_; ++j)
    noise_(j, j) = std::max(noise_(j, j), noise_floor_.size() > 0 ? noise_floor_(j) * noise_floor_(j) : 0.0);
  if (options_.noise != OutputNoise::kFull) {
    whitener_ = noise_.diagonal().cwiseSqrt().cwiseInverse().asDiagonal();
    return;
  }
  // Outputs that repeat each other would make R singular: correlations are kept off 1.
  const Eigen::VectorXd sd = noise_.diagonal().cwiseSqrt();
  const Eigen::VectorXd inverse_sd = sd.cwiseInverse();
  const numerics::SymmetricEigen eigen = numerics::symmetric_eigen(numerics::scaled(inverse_sd, noise_, inverse_sd));
  if (eigen.values(0) < 1e-10)
    noise_ = numerics::scaled(sd, numerics::from_eigen(eigen.vectors, eigen.values.cwiseMax(1e-10)), sd);
  whitener_ = numerics::Cholesky(noise_).solve_lower(Eigen::MatrixXd::Identity(outputs_, outputs_));
}

void OutputErrorProblem::start_noise() {
  if (options_.noise_start.size() > 0) return set_noise(options_.noise_start.cwiseAbs2().asDiagonal());
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(outputs_), count = sum;
  for (const Segment& s : segments_) {
    for (Index k = 0; k < s.residual.rows(); ++k) {
      for (Index j = 0; j < outputs_; ++j) {
        if (!std::isfinite(s.residual(k, j))) continue;
        sum(j) += s.residual(k, j) * s.residual(k, j);
        count(j) += 1.0;
      }
    }
  }
  Eigen::VectorXd variance = Eigen::VectorXd::Ones(outputs_);
  for (Index j = 0; j < outputs_; ++j)
    if (count(j) > 0.0 && sum(j) > 0.0) variance(j) = sum(j) / count(j);
  set_noise(variance.asDiagonal());
}

double OutputErrorProblem::update_noise() {
  if (!estimates_noise()) {
    if (options_.model_error) update_discount();
    return 0.0;
  }
  const bool full = options_.noise == OutputNoise::kFull;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(outputs_, outputs_);
  Eigen::VectorXd count = Eigen::VectorXd::Zero(outputs_);
  for (const Segment& segment : segments_) {
    const RowMatrix& r = segment.residual;
    for (Index k = 0; k < r.rows(); ++k) {
      std::vector<Index> seen, missing;
      for (Index j = 0; j < outputs_; ++j) (std::isfinite(r(k, j)) ? seen : missing).push_back(j);
      if (!full) {
        for (const Index j : seen) {
          sum(j, j) += r(k, j) * r(k, j);
          count(j) += 1.0;
        }
        continue;
      }
      if (seen.empty()) continue;
      count.array() += 1.0;
      // Expectation step: missing residuals replaced by their conditional mean, their conditional covariance added.
      Eigen::VectorXd e = Eigen::VectorXd::Zero(outputs_);
      for (const Index j : seen) e(j) = r(k, j);
      if (!missing.empty()) {
        const Eigen::MatrixXd gain =
            numerics::Cholesky(noise_(seen, seen)).solve(Eigen::MatrixXd(noise_(seen, missing))).transpose();
        e(missing) = gain * e(seen);
        sum(missing, missing) += noise_(missing, missing) - gain * noise_(seen, missing);
      }
      sum += e * e.transpose();
    }
  }
  Eigen::MatrixXd updated = noise_;
  for (Index i = 0; i < outputs_; ++i) {
    for (Index j = 0; j < outputs_; ++j)
      if (count(i) > 0.0 && (full || i == j)) updated(i, j) = sum(i, j) / count(i);
  }
  const Eigen::VectorXd before = noise_.diagonal().cwiseSqrt();
  set_noise(updated);
  if (options_.model_error) update_discount();
  double change = 0.0;
  for (Index j = 0; j < outputs_; ++j) change = std::max(change, std::abs(std::sqrt(noise_(j, j)) / before(j) - 1.0));
  return change;
}

double OutputErrorProblem::prior_root(const ModelParameter& unknown) const {
  return std::sqrt(discount_) / unknown.prior_sigma;
}

void OutputErrorProblem::update_discount() {
  constexpr double kInputNoise = 1.1;
  const InputNoise& inputs = options_.input_noise;
  const std::vector<RowMatrix> residuals = whitened_residuals();
  double energy = 0.0, by_noise = 0.0;
  for (Index j = 0; j < outputs_; ++j) {
    double products = 0.0, pairs = 0.0, power = 0.0, count = 0.0;
    for (const RowMatrix& r : residuals) {
      for (Index k = 0; k < r.rows(); ++k) {
        if (!std::isfinite(r(k, j))) continue;
        power += r(k, j) * r(k, j);
        count += 1.0;
        for (Index lag = 1; lag <= std::min(kColourLags, k); ++lag) {
          if (!std::isfinite(r(k - lag, j))) continue;
          products += r(k, j) * r(k - lag, j);
          pairs += 1.0;
        }
      }
    }
    if (!(power > 0.0) || !(pairs > 0.0)) continue;
    const bool by_inputs = inputs.autocovariance.size() > 0;
    const double expected = by_inputs ? kInputNoise * inputs.autocovariance(j) / noise_(j, j) : 0.0;
    const double memory = by_inputs ? inputs.memory(j) : 1.0;
    if (by_inputs) by_noise += std::min(1.0, inputs.variance(j) / noise_(j, j)) * (memory - 1.0);
    const double coloured = (products / pairs - expected) / (power / count);
    energy += count * std::max(0.0, coloured - 2.0 * std::sqrt(memory / pairs));
  }
  model_error_ = energy / static_cast<double>(std::max<Index>(1, shared_.size()));
  discount_ = 1.0 + by_noise / static_cast<double>(outputs_) + model_error_;
}

double OutputErrorProblem::negative_log_likelihood() const {
  double sum = 0.0;
  for (const Segment& segment : segments_) {
    sum += 0.5 * segment.triangle.squares;
    for (Index k = 0; k < segment.residual.rows(); ++k) {
      std::vector<Index> seen;
      for (Index j = 0; j < outputs_; ++j)
        if (std::isfinite(segment.residual(k, j))) seen.push_back(j);
      if (seen.empty()) continue;
      if (options_.noise != OutputNoise::kFull) {
        for (const Index j : seen) sum += 0.5 * std::log(noise_(j, j));
      } else {
        const Eigen::MatrixXd L = numerics::Cholesky(noise_(seen, seen)).L();
        sum += L.diagonal().array().log().sum();
      }
    }
  }
  return sum;
}

}  // namespace veridyn::estimation::internal
