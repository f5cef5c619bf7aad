#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "veridyn/muscle/dynamics/dynamics.hpp"

namespace veridyn::muscle {

/// Derivatives of tau = M qddot + h(q, qdot) with respect to q and qdot in closed form, in ground axes: a change of one
/// coordinate carries all that is beyond it along rigidly, so that forces there change only by what the motion of the
/// ground's side looks like from them (the idea of Carpentier & Mansard, Robotics: Science and Systems 2018):
///
///     dq_k:     dV = c,  dA = A_p x S_k - c x V_p + c x V,  c = V_p x S_k, and the force turns with S_k
///     dqdot_k:  dV = c,  dA = 2 V_p x S_k + c x V,          c = S_k
///
/// with the column S_k and velocity and acceleration V_p, A_p of the link before it. A workspace for one thread.
class InverseDynamicsDerivatives {
 public:
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  /// For rows and columns of `coordinates`. All joints must be simple (`available`).
  InverseDynamicsDerivatives(const Mechanism& mechanism, std::span<const int> coordinates);

  /// Every joint is a pin or a slider, driven linearly by a coordinate of its own.
  [[nodiscard]] static bool available(const Mechanism& mechanism);

  /// After `dynamics.set_state` and `dynamics.inverse_dynamics` with the accelerations concerned, on the same
  /// mechanism: `by_value` and `by_speed`, dtau_i/dq_k and dtau_i/dqdot_k in the order of the coordinates. Does not
  /// allocate.
  void evaluate(const Dynamics<double>& dynamics);
  [[nodiscard]] const Matrix& by_value() const { return by_value_; }
  [[nodiscard]] const Matrix& by_speed() const { return by_speed_; }

 private:
  std::vector<int> coordinates_;
  std::vector<int> row_;  ///< by link: of its coordinate; -1: none
  std::vector<int> parent_;
  std::vector<std::vector<int>> beyond_;  ///< by coordinate: its link and those it carries, tips first
  std::vector<RigidInertia<double>> inertia_;
  std::vector<SpatialVector<double>> momentum_, force_value_, force_speed_;
  Matrix by_value_, by_speed_;
};

}  // namespace veridyn::muscle
