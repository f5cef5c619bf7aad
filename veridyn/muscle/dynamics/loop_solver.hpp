#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "veridyn/core/index.hpp"
#include "veridyn/muscle/dynamics/coordinate_reduction.hpp"
#include "veridyn/muscle/dynamics/loop_constraints.hpp"
#include "veridyn/muscle/model/scalar.hpp"

namespace veridyn::muscle {

/// View of constraints and a reduction, which must outlive it: rows A dz = 0 of the loops over the free coordinates,
/// and the multipliers that meet them. A workspace for one thread; does not allocate or throw.
///
/// Loops repeat each other's rows (a hinge that closes a plane linkage holds it in the plane once more): rows that
/// follow from others are left out, their multipliers are 0. Motions do not depend on which.
template <typename Scalar>
class LoopSolver {
 public:
  LoopSolver(const LoopConstraints& loops, const CoordinateReduction& reduction);

  /// Errors, rates and rows for a state whose velocities are set.
  void update(const Kinematics<Scalar>& kinematics, const ExpandedState<Scalar>& state);

  [[nodiscard]] const LoopConstraints& loops() const { return *loops_; }
  [[nodiscard]] int rows() const { return static_cast<int>(rows_.size()); }
  [[nodiscard]] const LoopRow<Scalar>& row(int r) const { return rows_[r]; }
  /// Over the free coordinates.
  [[nodiscard]] const Scalar* jacobian(int r) const { return jacobian_.data() + at(r) * free_; }

  /// Multipliers of (A Y') lambda = wanted, by row: rows of Y are M^-1 A' of each row, over the free coordinates.
  void solve(const Scalar* Y, const Scalar* wanted);
  [[nodiscard]] const Scalar& multiplier(int r) const { return multiplier_[r]; }

  /// Adds the constraints' generalised forces, by coordinate.
  void add_generalized_forces(const Kinematics<Scalar>& kinematics, Scalar* tau) const;

  /// Below it, relative to what it was summed from, a number is rounding.
  static constexpr double kRounding = 1e-10;

 private:
  const LoopConstraints* loops_;
  const CoordinateReduction* reduction_;
  std::size_t free_;
  std::vector<LoopRow<Scalar>> rows_;
  std::vector<Scalar> jacobian_, matrix_, multiplier_;
  std::vector<double> scale_;
  std::vector<int> order_;
  std::vector<char> done_;
};

// Details ------------------------------------------------------------------------------------------------------------

template <typename Scalar>
LoopSolver<Scalar>::LoopSolver(const LoopConstraints& loops, const CoordinateReduction& reduction)
    : loops_(&loops),
      reduction_(&reduction),
      free_(reduction.free().size()),
      rows_(at(loops.rows())),
      jacobian_(rows_.size() * free_),
      matrix_(rows_.size() * rows_.size()),
      multiplier_(rows_.size()),
      scale_(rows_.size()),
      order_(rows_.size()),
      done_(rows_.size()) {}

template <typename Scalar>
void LoopSolver<Scalar>::update(const Kinematics<Scalar>& kinematics, const ExpandedState<Scalar>& state) {
  loops_->evaluate(kinematics, rows_.data());
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    Scalar* const entries = jacobian_.data() + r * free_;
    for (std::size_t i = 0; i < free_; ++i) entries[i] = Scalar(0.0);
    const SpatialVector<Scalar>& force = rows_[r].force;
    double size = 0.0;
    const auto add = [&](int c, double sign) {
      const int i = reduction_->free_root(c);
      if (i < 0) return;
      const SpatialVector<Scalar>& column = kinematics.columns[c];
      const Scalar& slope = state.slope(c);
      entries[i] += column.dot(force) * slope * Scalar(sign);
      // What the product was summed from: both lever arms count in full, whatever cancelled in them.
      const auto norm = [](const Vector3<Scalar>& v) { return std::sqrt(value_of(v.squaredNorm())); };
      const double lever = rows_[r].reach + norm(kinematics.pose[loops_->link_of(c)].position);
      size = std::max(
          size, std::abs(value_of(slope)) * (norm(column.angular) * (norm(force.angular) + lever * norm(force.linear)) +
                                             norm(column.linear) * norm(force.linear)));
    };
    for (const int c : loops_->moving_2(static_cast<int>(r))) add(c, 1.0);
    for (const int c : loops_->moving_1(static_cast<int>(r))) add(c, -1.0);
    // A direction in which nothing can move, but for rounding.
    bool moves = false;
    for (std::size_t i = 0; i < free_; ++i) moves = moves || std::abs(value_of(entries[i])) > kRounding * size;
    if (moves) continue;
    for (std::size_t i = 0; i < free_; ++i) entries[i] = Scalar(0.0);
  }
}

template <typename Scalar>
void LoopSolver<Scalar>::solve(const Scalar* Y, const Scalar* wanted) {
  const std::size_t m = rows_.size();
  for (std::size_t r = 0; r < m; ++r) {
    for (std::size_t s = 0; s < m; ++s) {
      Scalar sum(0.0);
      for (std::size_t i = 0; i < free_; ++i) sum += jacobian_[r * free_ + i] * Y[s * free_ + i];
      matrix_[r * m + s] = sum;
    }
    scale_[r] = value_of(matrix_[r * m + r]);
    multiplier_[r] = wanted[r];
    done_[r] = 0;
  }
  // L D L' with the best of the remaining pivots, until what is left is rounding: the matrix is semidefinite.
  std::size_t rank = 0;
  for (; rank < m; ++rank) {
    std::size_t p = m;
    double best = kRounding;
    for (std::size_t r = 0; r < m; ++r) {
      if (done_[r] != 0 || !(scale_[r] > 0.0)) continue;
      const double left = value_of(matrix_[r * m + r]) / scale_[r];
      if (left > best) {
        best = left;
        p = r;
      }
    }
    if (p == m) break;
    done_[p] = 1;
    order_[rank] = static_cast<int>(p);
    const Scalar inverse = Scalar(1.0) / matrix_[p * m + p];
    for (std::size_t r = 0; r < m; ++r) {
      if (done_[r] != 0) continue;
      const Scalar factor = matrix_[r * m + p] * inverse;
      for (std::size_t s = 0; s < m; ++s)
        if (done_[s] == 0) matrix_[r * m + s] -= factor * matrix_[p * m + s];
      multiplier_[r] -= factor * multiplier_[p];
    }
  }
  for (std::size_t r = 0; r < m; ++r)
    if (done_[r] == 0) multiplier_[r] = Scalar(0.0);
  for (std::size_t k = rank; k-- > 0;) {
    const auto p = at(order_[k]);
    for (std::size_t l = k + 1; l < rank; ++l) multiplier_[p] -= matrix_[p * m + order_[l]] * multiplier_[order_[l]];
    multiplier_[p] /= matrix_[p * m + p];
  }
}

template <typename Scalar>
void LoopSolver<Scalar>::add_generalized_forces(const Kinematics<Scalar>& kinematics, Scalar* tau) const {
  for (int r = 0; r < rows(); ++r) {
    for (const int c : loops_->moving_2(r)) tau[c] += kinematics.columns[c].dot(row(r).force) * multiplier(r);
    for (const int c : loops_->moving_1(r)) tau[c] -= kinematics.columns[c].dot(row(r).force) * multiplier(r);
  }
}

}  // namespace veridyn::muscle
