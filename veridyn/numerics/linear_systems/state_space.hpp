#pragma once

#include <Eigen/Core>
#include <complex>

#include "veridyn/numerics/linear_systems/transfer_function.hpp"

namespace veridyn::numerics {

/// x' = A x + B u, y = C x + D u; or x(k+1) = A x(k) + B u(k) of a discrete system.
struct StateSpace {
  Eigen::MatrixXd A, B, C, D;

  [[nodiscard]] Eigen::Index states() const { return A.rows(); }
  [[nodiscard]] Eigen::Index inputs() const { return D.cols(); }
  [[nodiscard]] Eigen::Index outputs() const { return D.rows(); }
  /// Of a continuous system at s = j omega: outputs x inputs. @param omega [rad/s]
  [[nodiscard]] Eigen::MatrixXcd response(double omega) const;
  /// Of a discrete system at z = e^(j omega step). @param step [s]
  [[nodiscard]] Eigen::MatrixXcd response(double omega, double step) const;
  /// @throws InputError where sizes do not fit or an entry is not finite.
  void validate() const;
};

/// Realisation of a transfer function, as many states as its denominator has degrees: companion form in the time scale
/// of its poles' geometric mean, so that its entries are of like size. @throws as `TransferFunction::normalise`.
[[nodiscard]] StateSpace realise(TransferFunction transfer);

/// `second` takes the outputs of `first`.
[[nodiscard]] StateSpace in_series(const StateSpace& first, const StateSpace& second);

}  // namespace veridyn::numerics
