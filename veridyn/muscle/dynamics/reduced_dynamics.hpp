#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/dynamics/coordinate_reduction.hpp"
#include "veridyn/muscle/dynamics/dynamics.hpp"
#include "veridyn/muscle/dynamics/loop_solver.hpp"

namespace veridyn::muscle {

/// View of a mechanism, a reduction and, where there are any, constraints that close loops, all of which must outlive
/// it: dynamics of the free coordinates,
///
///     J' M J zddot = J' (tau - h - M bias) + A' lambda,   A zddot + ... = d2(error)/dt2 = -2 w rate - w^2 error
///
/// with all coordinates' forces tau. Forces of couplers and drives do no work on the free coordinates and need not be
/// known. Errors of loops, which integration makes, die out with the rate w (Baumgarte 1972, Comput Methods Appl Mech
/// Eng 1:1). A workspace for one thread; does not allocate or throw.
template <typename Scalar>
class ReducedDynamics {
 public:
  ReducedDynamics(const Mechanism& mechanism, const CoordinateReduction& reduction,
                  const LoopConstraints* loops = nullptr);

  /// `driven` may be null when nothing is driven.
  void set_state(const Scalar* z, const Scalar* zdot, const DrivenMotion<Scalar>* driven);

  /// zddot for forces tau on all coordinates (by coordinate; those on driven ones have no effect) and on links (see
  /// `Dynamics::inverse_dynamics`). All coordinates' accelerations are in `qddot()` afterwards.
  Factorization forward_dynamics(const Scalar* tau, const SpatialVector<Scalar>* applied, Scalar* zddot);

  /// Null without loops. After `forward_dynamics` it holds their multipliers.
  [[nodiscard]] const LoopSolver<Scalar>* loops() const { return loops_ ? &*loops_ : nullptr; }
  /// The loops' errors and rows at the state set, for assembly.
  LoopSolver<Scalar>& update_loops();

  [[nodiscard]] const ExpandedState<Scalar>& state() const { return state_; }
  [[nodiscard]] const Eigen::Matrix<Scalar, Eigen::Dynamic, 1>& qddot() const { return qddot_; }
  [[nodiscard]] const CoordinateReduction& reduction() const { return *reduction_; }
  [[nodiscard]] Dynamics<Scalar>& dynamics() { return dynamics_; }
  [[nodiscard]] const Kinematics<Scalar>& kinematics() const { return dynamics_.kinematics(); }

  /// Rate w at which errors of loops die out [1/s]: fast against motions, slow against steps of the integration.
  static constexpr double kLoopRate = 20.0;

 private:
  /// J' M J and J' (tau - residual_), which goes to zddot.
  void assemble(const Scalar* tau, Scalar* zddot);
  [[nodiscard]] Factorization factorize();
  /// x = (J' M J)^-1 x after `factorize`.
  void solve(Scalar* x) const;
  void meet_loops(Scalar* zddot);

  const CoordinateReduction* reduction_;
  Dynamics<Scalar> dynamics_;
  ExpandedState<Scalar> state_;
  Eigen::Matrix<Scalar, Eigen::Dynamic, 1> qddot_, residual_, scale_;
  /// Lower triangle of J' M J; then its factors.
  Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> mass_;
  std::optional<LoopSolver<Scalar>> loops_;
  std::vector<Scalar> moved_;   ///< M^-1 A', row after row
  std::vector<Scalar> wanted_;  ///< by row
};

// Details ------------------------------------------------------------------------------------------------------------

template <typename Scalar>
ReducedDynamics<Scalar>::ReducedDynamics(const Mechanism& mechanism, const CoordinateReduction& reduction,
                                         const LoopConstraints* loops)
    : reduction_(&reduction),
      dynamics_(mechanism),
      state_(mechanism.coordinates()),
      qddot_(mechanism.coordinates()),
      residual_(mechanism.coordinates()),
      scale_(signed_index(reduction.free().size())),
      mass_(scale_.size(), scale_.size()) {
  if (loops == nullptr || loops->empty()) return;
  loops_.emplace(*loops, reduction);
  moved_.resize(at(loops->rows()) * reduction.free().size());
  wanted_.resize(at(loops->rows()));
}

template <typename Scalar>
void ReducedDynamics<Scalar>::set_state(const Scalar* z, const Scalar* zdot, const DrivenMotion<Scalar>* driven) {
  expand(*reduction_, z, zdot, driven, state_);
  dynamics_.set_state(state_.q.data(), state_.qdot.data());
}

template <typename Scalar>
LoopSolver<Scalar>& ReducedDynamics<Scalar>::update_loops() {
  loops_->update(dynamics_.kinematics(), state_);
  return *loops_;
}

template <typename Scalar>
Factorization ReducedDynamics<Scalar>::forward_dynamics(const Scalar* tau, const SpatialVector<Scalar>* applied,
                                                        Scalar* zddot) {
  const Mechanism& mechanism = dynamics_.mechanism();
  if (reduction_->all_free() && !loops_) {
    const Factorization result = dynamics_.forward_dynamics(tau, applied, qddot_.data());
    for (int c = 0; c < mechanism.coordinates(); ++c) zddot[c] = qddot_(c);
    return result;
  }
  dynamics_.inverse_dynamics(state_.bias.data(), applied, residual_.data());
  dynamics_.update_mass_rows();
  if (reduction_->free_are_uncoupled() && !loops_) {
    for (int c = 0; c < mechanism.coordinates(); ++c) qddot_(c) = tau[c] - residual_(c);
    const Factorization result = dynamics_.solve_mass(reduction_->follows_driven(), qddot_.data());
    for (std::size_t i = 0; i < reduction_->free().size(); ++i) zddot[i] = qddot_(reduction_->free()[i]);
    qddot_ += state_.bias;
    return result;
  }
  assemble(tau, zddot);
  const Factorization result = factorize();
  if (!result.usable()) return result;
  solve(zddot);
  if (loops_) meet_loops(zddot);
  for (int c = 0; c < mechanism.coordinates(); ++c) {
    const int i = reduction_->free_root(c);
    qddot_(c) = state_.bias(c);
    if (i >= 0) qddot_(c) += state_.slope(c) * zddot[i];
  }
  return {};
}

template <typename Scalar>
void ReducedDynamics<Scalar>::assemble(const Scalar* tau, Scalar* zddot) {
  const Mechanism& mechanism = dynamics_.mechanism();
  mass_.setZero();
  scale_.setZero();
  for (Eigen::Index i = 0; i < scale_.size(); ++i) zddot[i] = Scalar(0.0);
  for (int c = 0; c < mechanism.coordinates(); ++c) {
    const int i = reduction_->free_root(c);
    if (i < 0) continue;
    const Scalar& slope = state_.slope(c);
    zddot[i] += slope * (tau[c] - residual_(c));
    scale_(i) += slope * slope * dynamics_.mass_scale(c);
    const Scalar* row = dynamics_.mass_row(c);
    for (const int d : mechanism.chain(c)) {
      const Scalar& entry = *row++;
      const int j = reduction_->free_root(d);
      if (j < 0) continue;
      const Scalar value = slope * state_.slope(d) * entry;
      // Entries (c, d) and (d, c) of M meet on the diagonal when both follow the same coordinate.
      if (i == j) {
        mass_(i, i) += c == d ? value : Scalar(2.0) * value;
      } else {
        mass_(i > j ? i : j, i > j ? j : i) += value;
      }
    }
  }
}

/// L' D L from the last to the first, as along the tree.
template <typename Scalar>
Factorization ReducedDynamics<Scalar>::factorize() {
  const auto n = static_cast<int>(scale_.size());
  for (int k = n - 1; k >= 0; --k) {
    Scalar* const row = mass_.data() + k * n;
    if (!(row[k] > Dynamics<Scalar>::kSingularPivot * scale_(k))) return {reduction_->free()[k]};
    const Scalar inverse = Scalar(1.0) / row[k];
    row[k] = inverse;
    for (int i = k - 1; i >= 0; --i) {
      const Scalar factor = row[i] * inverse;
      Scalar* const other = mass_.data() + i * n;
      for (int j = 0; j <= i; ++j) other[j] -= factor * row[j];
      row[i] = factor;
    }
  }
  return {};
}

template <typename Scalar>
void ReducedDynamics<Scalar>::solve(Scalar* x) const {
  const auto n = static_cast<int>(scale_.size());
  for (int k = n - 1; k >= 0; --k) {
    const Scalar* const row = mass_.data() + k * n;
    for (int i = 0; i < k; ++i) x[i] -= row[i] * x[k];
  }
  for (int k = 0; k < n; ++k) {
    const Scalar* const row = mass_.data() + k * n;
    Scalar sum = x[k] * row[k];
    for (int i = 0; i < k; ++i) sum -= row[i] * x[i];
    x[k] = sum;
  }
}

/// Adds to zddot what the constraints' forces make of it.
template <typename Scalar>
void ReducedDynamics<Scalar>::meet_loops(Scalar* zddot) {
  LoopSolver<Scalar>& loops = update_loops();
  const std::size_t n = reduction_->free().size();
  for (int r = 0; r < loops.rows(); ++r) {
    const LoopRow<Scalar>& row = loops.row(r);
    const LoopConstraints::Constraint& constraint = loops.loops().of_row(r);
    // Accelerations of the links without zddot, as inverse dynamics left them.
    const SpatialVector<Scalar>&one = dynamics_.acceleration(constraint.link_1),
          &two = dynamics_.acceleration(constraint.link_2);
    const SpatialVector<Scalar> relative{two.angular - one.angular, two.linear - one.linear};
    Scalar left = -(row.rate_bias + row.force.dot(relative)) - row.rate * Scalar(2.0 * kLoopRate) -
                  row.error * Scalar(kLoopRate * kLoopRate);
    Scalar* const Y = moved_.data() + at(r) * n;
    const Scalar* const A = loops.jacobian(r);
    for (std::size_t i = 0; i < n; ++i) {
      left -= A[i] * zddot[i];
      Y[i] = A[i];
    }
    solve(Y);
    wanted_[r] = left;
  }
  loops.solve(moved_.data(), wanted_.data());
  for (int r = 0; r < loops.rows(); ++r) {
    const Scalar* const Y = moved_.data() + at(r) * n;
    for (std::size_t i = 0; i < n; ++i) zddot[i] += loops.multiplier(r) * Y[i];
  }
}

extern template class ReducedDynamics<double>;  // in dynamics.cpp

}  // namespace veridyn::muscle
