#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

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
  std::vector<int> free_, driven_, free_root_;
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

}  // namespace veridyn::muscle
