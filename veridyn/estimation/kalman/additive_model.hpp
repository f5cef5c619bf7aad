#pragma once

#include <Eigen/Core>

namespace veridyn::estimation {

/// The part of a system model (see `SystemModel`) whose state is a vector, as its error is: both are added and taken
/// apart number by number. A model inherits it.
template <int N>
struct AdditiveModel {
  static constexpr int kStates = N;
  template <typename Scalar>
  using State = Eigen::Matrix<Scalar, N, 1>;

  template <typename Scalar>
  [[nodiscard]] static State<Scalar> retract(const State<double>& x, const State<Scalar>& error) {
    return x.template cast<Scalar>() + error;
  }
  template <typename Scalar>
  [[nodiscard]] static State<Scalar> local(const State<double>& from, const State<Scalar>& to) {
    return to - from.template cast<Scalar>();
  }
};

}  // namespace veridyn::estimation
