#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "veridyn/muscle/dynamics/dynamics.hpp"
#include "veridyn/muscle/model/model.hpp"

namespace veridyn::muscle {

/// What determines the motion of a coordinate.
enum class CoordinateRole {
  kFree,     ///< the forces: a coordinate of the equations of motion
  kCoupled,  ///< another coordinate, by a coupler's function
  kDriven,   ///< the caller: locked in the model, or prescribed
};

/// Motion that the caller gives a driven coordinate.
template <typename Scalar>
struct DrivenMotion {
  Scalar value{};
  Scalar speed{};
  Scalar acceleration{};
};

/// All coordinates as functions of the free ones z: q = f(z, t), qdot = J zdot + ..., qddot = J zddot + bias.
///
/// Every coordinate follows one other at most (itself, the free or driven coordinate at the end of its couplers), so
/// that J is one number a coordinate.
class CoordinateReduction {
 public:
  /// `prescribed`: coordinates that the caller drives although the model does not lock them.
  /// @throws InputError naming the coordinate that two couplers set, that couplers lead back to, or that a coupler sets
  /// although it is locked or prescribed.
  explicit CoordinateReduction(const Model& model, std::span<const int> prescribed = {});

  [[nodiscard]] CoordinateRole role(int coordinate) const { return roles_[coordinate]; }
  [[nodiscard]] int coordinates() const { return static_cast<int>(roles_.size()); }
  /// Free coordinates, in the model's order: z(i) is coordinate free()[i].
  [[nodiscard]] std::span<const int> free() const { return free_; }
  [[nodiscard]] std::span<const int> driven() const { return driven_; }
  /// Index in `free()` of the coordinate that this one follows; -1 when that is a driven one.
  [[nodiscard]] int free_root(int coordinate) const { return free_root_[coordinate]; }
  /// The same in `driven()`.
  [[nodiscard]] int driven_root(int coordinate) const { return driven_root_[coordinate]; }
  /// What a generalised force on coordinate c adds to that on `coordinate`: 1 for itself, the slope (by coordinate, of
  /// `ExpandedState`) of those that follow it when it is free, else 0.
  [[nodiscard]] double share_in(int c, int coordinate, const double* slope) const {
    if (c == coordinate) return 1.0;
    const bool follows = role(coordinate) == CoordinateRole::kFree && free_root(c) == free_root(coordinate);
    return follows ? slope[c] : 0.0;
  }
  [[nodiscard]] bool all_free() const { return free_.size() == roles_.size(); }
  /// No coordinate is coupled to a free one: the equations are those of the tree without the rest.
  [[nodiscard]] bool free_are_uncoupled() const { return free_are_uncoupled_; }
  /// By coordinate: 1 where it follows a driven one (or is one), else 0.
  [[nodiscard]] const char* follows_driven() const { return follows_driven_.data(); }

  /// Driven coordinates resting at their default values.
  [[nodiscard]] std::vector<DrivenMotion<double>> default_motion() const;

  /// value(dependent) = function(value(independent))
  struct Coupler {
    int independent = 0;
    int dependent = 0;
    numerics::PiecewisePolynomial function;
  };
  /// Each after the one that sets its independent coordinate.
  [[nodiscard]] std::span<const Coupler> couplers() const { return couplers_; }

 private:
  std::vector<CoordinateRole> roles_;
  std::vector<int> free_, driven_, free_root_, driven_root_;
  std::vector<Coupler> couplers_;
  std::vector<double> defaults_;  ///< of driven coordinates
  std::vector<char> follows_driven_;
  bool free_are_uncoupled_ = true;
};

/// What `expand` finds: by coordinate.
template <typename Scalar>
struct ExpandedState {
  explicit ExpandedState(int coordinates) : q(coordinates), qdot(coordinates), slope(coordinates), bias(coordinates) {}
  Eigen::Matrix<Scalar, Eigen::Dynamic, 1> q, qdot;
  Eigen::Matrix<Scalar, Eigen::Dynamic, 1> slope;  ///< dq / d(the coordinate it follows)
  Eigen::Matrix<Scalar, Eigen::Dynamic, 1> bias;   ///< qddot when zddot = 0
};

/// Coordinates, speeds and biases from the free coordinates z, their speeds and the motion of the driven ones (in the
/// order of `driven()`). By the chain rule through the couplers: with q = f(p), qddot = f' pddot + f'' pdot^2. Does not
/// allocate.
template <typename Scalar>
void expand(const CoordinateReduction& reduction, const Scalar* z, const Scalar* zdot,
            const DrivenMotion<Scalar>* driven, ExpandedState<Scalar>& state);

/// View of a mechanism and a reduction, both of which must outlive it: dynamics of the free coordinates,
/// J' M J zddot = J' (tau - h - M bias), with all coordinates' forces tau. Constraint forces of couplers and drives do
/// no work on the free coordinates and need not be known. A workspace for one thread; does not allocate or throw.
template <typename Scalar>
class ReducedDynamics {
 public:
  ReducedDynamics(const Mechanism& mechanism, const CoordinateReduction& reduction);

  /// `driven` may be null when nothing is driven.
  void set_state(const Scalar* z, const Scalar* zdot, const DrivenMotion<Scalar>* driven);

  /// zddot for forces tau on all coordinates (by coordinate; those on driven ones have no effect) and on links (see
  /// `Dynamics::inverse_dynamics`). All coordinates' accelerations are in `qddot()` afterwards.
  Factorization forward_dynamics(const Scalar* tau, const SpatialVector<Scalar>* applied, Scalar* zddot);

  /// After `forward_dynamics` with the same arguments: the forces that drive the driven coordinates, with those
  /// of coordinates that couplers make follow them. [N m or N], in the order of `driven()`.
  void driving_forces(const Scalar* tau, const SpatialVector<Scalar>* applied, Scalar* forces);

  [[nodiscard]] const ExpandedState<Scalar>& state() const { return state_; }
  [[nodiscard]] const Eigen::Matrix<Scalar, Eigen::Dynamic, 1>& qddot() const { return qddot_; }
  [[nodiscard]] const CoordinateReduction& reduction() const { return *reduction_; }
  [[nodiscard]] Dynamics<Scalar>& dynamics() { return dynamics_; }
  [[nodiscard]] const Kinematics<Scalar>& kinematics() const { return dynamics_.kinematics(); }

 private:
  const CoordinateReduction* reduction_;
  Dynamics<Scalar> dynamics_;
  ExpandedState<Scalar> state_;
  Eigen::Matrix<Scalar, Eigen::Dynamic, 1> qddot_, residual_, scale_;
  /// Lower triangle of J' M J.
  Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> mass_;
};

// Details ------------------------------------------------------------------------------------------------------------

template <typename Scalar>
void expand(const CoordinateReduction& reduction, const Scalar* z, const Scalar* zdot,
            const DrivenMotion<Scalar>* driven, ExpandedState<Scalar>& state) {
  const std::span<const int> free = reduction.free();
  for (std::size_t i = 0; i < free.size(); ++i) {
    const int c = free[i];
    state.q(c) = z[i];
    state.qdot(c) = zdot[i];
    state.slope(c) = Scalar(1.0);
    state.bias(c) = Scalar(0.0);
  }
  const std::span<const int> fixed = reduction.driven();
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    const int c = fixed[i];
    state.q(c) = driven[i].value;
    state.qdot(c) = driven[i].speed;
    state.slope(c) = Scalar(1.0);
    state.bias(c) = driven[i].acceleration;
  }
  for (const CoordinateReduction::Coupler& coupler : reduction.couplers()) {
    const int from = coupler.independent, to = coupler.dependent;
    const numerics::FunctionValue<Scalar> f = coupler.function.evaluate(state.q(from));
    state.q(to) = f.value;
    state.qdot(to) = f.slope * state.qdot(from);
    state.slope(to) = f.slope * state.slope(from);
    state.bias(to) = f.slope * state.bias(from) + f.curvature * state.qdot(from) * state.qdot(from);
  }
}

template <typename Scalar>
ReducedDynamics<Scalar>::ReducedDynamics(const Mechanism& mechanism, const CoordinateReduction& reduction)
    : reduction_(&reduction),
      dynamics_(mechanism),
      state_(mechanism.coordinates()),
      qddot_(mechanism.coordinates()),
      residual_(mechanism.coordinates()),
      scale_(reduction.free().size()),
      mass_(scale_.size(), scale_.size()) {}

template <typename Scalar>
void ReducedDynamics<Scalar>::set_state(const Scalar* z, const Scalar* zdot, const DrivenMotion<Scalar>* driven) {
  expand(*reduction_, z, zdot, driven, state_);
  dynamics_.set_state(state_.q.data(), state_.qdot.data());
}

template <typename Scalar>
Factorization ReducedDynamics<Scalar>::forward_dynamics(const Scalar* tau, const SpatialVector<Scalar>* applied,
                                                        Scalar* zddot) {
  const Mechanism& mechanism = dynamics_.mechanism();
  if (reduction_->all_free()) {
    const Factorization result = dynamics_.forward_dynamics(tau, applied, qddot_.data());
    for (int c = 0; c < mechanism.coordinates(); ++c) zddot[c] = qddot_(c);
    return result;
  }
  dynamics_.inverse_dynamics(state_.bias.data(), applied, residual_.data());
  dynamics_.update_mass_rows();
  const auto n = static_cast<int>(scale_.size());
  if (reduction_->free_are_uncoupled()) {
    for (int c = 0; c < mechanism.coordinates(); ++c) qddot_(c) = tau[c] - residual_(c);
    const Factorization result = dynamics_.solve_mass(reduction_->follows_driven(), qddot_.data());
    for (int i = 0; i < n; ++i) zddot[i] = qddot_(reduction_->free()[i]);
    qddot_ += state_.bias;
    return result;
  }
  mass_.setZero();
  scale_.setZero();
  for (int i = 0; i < n; ++i) zddot[i] = Scalar(0.0);
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
  // L' D L from the last to the first, as along the tree.
  for (int k = n - 1; k >= 0; --k) {
    Scalar* const row = mass_.data() + k * n;
    if (!(row[k] > Dynamics<Scalar>::kSingularPivot * scale_(k))) {
      return {reduction_->free()[k]};
    }
    const Scalar inverse = Scalar(1.0) / row[k];
    row[k] = inverse;
    for (int i = k - 1; i >= 0; --i) {
      const Scalar factor = row[i] * inverse;
      Scalar* const other = mass_.data() + i * n;
      for (int j = 0; j <= i; ++j) other[j] -= factor * row[j];
      zddot[i] -= factor * zddot[k];
      row[i] = factor;
    }
  }
  for (int k = 0; k < n; ++k) {
    const Scalar* const row = mass_.data() + k * n;
    Scalar x = zddot[k] * row[k];
    for (int i = 0; i < k; ++i) x -= row[i] * zddot[i];
    zddot[k] = x;
  }
  for (int c = 0; c < mechanism.coordinates(); ++c) {
    const int i = reduction_->free_root(c);
    qddot_(c) = state_.bias(c);
    if (i >= 0) qddot_(c) += state_.slope(c) * zddot[i];
  }
  return {};
}

template <typename Scalar>
void ReducedDynamics<Scalar>::driving_forces(const Scalar* tau, const SpatialVector<Scalar>* applied, Scalar* forces) {
  dynamics_.inverse_dynamics(qddot_.data(), applied, residual_.data());
  for (std::size_t i = 0; i < reduction_->driven().size(); ++i) forces[i] = Scalar(0.0);
  for (int c = 0; c < dynamics_.mechanism().coordinates(); ++c) {
    const int i = reduction_->driven_root(c);
    if (i >= 0) forces[i] += state_.slope(c) * (residual_(c) - tau[c]);
  }
}

extern template class ReducedDynamics<double>;  // in dynamics.cpp

}  // namespace veridyn::muscle
