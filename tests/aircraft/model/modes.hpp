#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include "veridyn/aircraft/model/trim.hpp"
#include "veridyn/numerics/linear_algebra/general_eigen.hpp"

namespace veridyn::aircraft::testing {

/// Eigenvalues of four of the states by themselves [1/s], by falling magnitude.
inline std::vector<std::complex<double>> eigenvalues_of(const LinearModel& model, const std::array<int, 4>& states) {
  const Eigen::MatrixXd A = model.A(states, states);
  const Eigen::VectorXcd values = numerics::general_eigenvalues(A);
  std::vector<std::complex<double>> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) {
    const double na = std::abs(a), nb = std::abs(b);
    return std::abs(na - nb) > 1e-9 * (na + nb) ? na > nb : a.imag() > b.imag();
  });
  return sorted;
}

/// Of u, w, q, theta.
inline std::vector<std::complex<double>> longitudinal_eigenvalues(const LinearModel& model) {
  return eigenvalues_of(model, {0, 2, 4, 7});
}
/// Of v, p, r, phi.
inline std::vector<std::complex<double>> lateral_eigenvalues(const LinearModel& model) {
  return eigenvalues_of(model, {1, 3, 5, 6});
}

}  // namespace veridyn::aircraft::testing
