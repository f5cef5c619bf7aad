#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "veridyn/numerics/filters.hpp"

namespace veridyn::numerics {

/// Covariance of several quantities at one instant, each a sum of white sources that went through filters of one
/// length: x_j = sum of coefficient * (kernel over source). Sources are independent of each other and white from sample
/// to sample; a quantity may see one source through several kernels.
class FilteredNoise {
 public:
  /// @param variances of the sources' samples, one each; those without noise cost nothing
  /// @param taps of every kernel that is added
  FilteredNoise(Eigen::Index quantities, std::span<const double> variances, std::size_t taps);

  /// Adds `coefficient` times the kernel over `source` to a quantity.
  void add(Eigen::Index quantity, std::size_t source, double coefficient, const FirKernel& kernel);
  /// quantities x quantities
  [[nodiscard]] Eigen::MatrixXd covariance() const;

 private:
  Eigen::Index quantities_;
  std::vector<double> variances_;
  std::vector<Eigen::MatrixXd> weights_;  ///< by source: taps x quantities
};

}  // namespace veridyn::numerics
