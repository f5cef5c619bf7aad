#include "veridyn/numerics/filtered_noise.hpp"

#include "veridyn/core/assert.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::numerics {

FilteredNoise::FilteredNoise(Eigen::Index quantities, std::span<const double> variances, std::size_t taps)
    : quantities_(quantities), variances_(variances.begin(), variances.end()) {
  weights_.reserve(variances_.size());
  for (const double variance : variances_)
    weights_.emplace_back(Eigen::MatrixXd::Zero(variance > 0.0 ? signed_index(taps) : 0, quantities));
}

void FilteredNoise::add(Eigen::Index quantity, std::size_t source, double coefficient, const FirKernel& kernel) {
  Eigen::MatrixXd& weights = weights_[source];
  if (weights.rows() == 0) return;
  VERIDYN_ASSERT(weights.rows() == signed_index(kernel.taps.size()));
  weights.col(quantity) += coefficient * Eigen::Map<const Eigen::VectorXd>(kernel.taps.data(), weights.rows());
}

Eigen::MatrixXd FilteredNoise::covariance() const {
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(quantities_, quantities_);
  for (std::size_t i = 0; i < weights_.size(); ++i)
    if (weights_[i].rows() > 0) W += variances_[i] * weights_[i].transpose() * weights_[i];
  return W;
}

}  // namespace veridyn::numerics
