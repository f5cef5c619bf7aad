#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/muscle/dynamics/coordinate_forces.hpp"
#include "veridyn/muscle/dynamics/coordinate_reduction.hpp"
#include "veridyn/muscle/dynamics/dynamics.hpp"
#include "veridyn/muscle/dynamics/mechanism.hpp"
#include "veridyn/muscle/model/model.hpp"
#include "veridyn/muscle/actuator/muscle_group.hpp"
#include "veridyn/muscle/path/muscle_path.hpp"
#include "veridyn/muscle/path/path_fit.hpp"

namespace veridyn::muscle {

/// Where path lengths and moment arms come from.
enum class PathSource {
  kExact,      ///< wrapping, computed at every pose
  kFitted,     ///< wrapping paths as polynomials fitted to it once, with a stated error; exact where no fit is good
  kAsOpenSim,  ///< OpenSim's own wrapping, jumps included, for comparisons; no derivatives
};

struct SystemOptions {
  PathSource paths = PathSource::kExact;
  /// Coordinates held at their start value, beside those that the model locks.
  std::vector<std::string> locked{};
  /// Coordinates that the model locks and that move all the same.
  std::vector<std::string> unlocked{};
  /// Go on although forces or constraints of the model are not understood.
  bool without_unsupported = false;
};

/// Where the states of a system stand in its state vector: free coordinates [rad or m], their speeds, activations of
/// the muscles that have one, fibre lengths [m] of the muscles that have one.
struct StateLayout {
  std::size_t free = 0;           ///< free coordinates; their speeds follow
  std::vector<int> activation;    ///< by muscle; -1: the excitation is the activation
  std::vector<int> fiber_length;  ///< by muscle; -1: the tendon is rigid
  std::size_t size = 0;
};

/// A model made ready for dynamics: tree, constraints, paths, muscles. Muscles that the file switches off are left out.
/// Immutable; used by many threads at once, each with its own `SystemEvaluator`.
class MusculoskeletalSystem {
 public:
  /// @throws InputError naming element and reason: forces that are not understood, unknown coordinates, a path point
  /// inside a wrap object at the default pose.
  explicit MusculoskeletalSystem(Model model, const SystemOptions& options = {});
  MusculoskeletalSystem(const MusculoskeletalSystem&) = delete;
  MusculoskeletalSystem& operator=(const MusculoskeletalSystem&) = delete;

  [[nodiscard]] const Model& model() const { return model_; }
  [[nodiscard]] const Mechanism& mechanism() const { return mechanism_; }
  [[nodiscard]] const CoordinateReduction& reduction() const { return reduction_; }
  [[nodiscard]] const MusclePaths& paths() const { return paths_; }
  /// Null unless paths are fitted.
  [[nodiscard]] const FittedPaths* fit() const { return fit_ ? &*fit_ : nullptr; }
  [[nodiscard]] PathSource path_source() const { return source_; }
  /// Muscles and coordinates of `SystemEvaluator::path_gradient`.
  [[nodiscard]] std::span<const MusclePaths::Pair> pairs() const { return fit_ ? fit_->pairs() : paths_.pairs(); }
  [[nodiscard]] const MuscleGroup<double>& muscles() const { return muscles_; }
  [[nodiscard]] const StateLayout& layout() const { return layout_; }
  [[nodiscard]] std::size_t coordinates() const { return model_.coordinates.size(); }
  /// Sizes of the states, for error control: 0.1 rad or m, 1 per second, activation 0.1, a tenth of L0. With them an
  /// accuracy of 1e-5 leaves arm26 within some 1e-6 rad after a second, as OpenSim's 1e-5 does.
  [[nodiscard]] std::span<const double> scales() const { return scales_; }
  /// "speed of coordinate 'elbow_flexion'", for messages.
  [[nodiscard]] std::string state_name(std::size_t index) const;
  /// What a user should know of it: forces left out, muscles switched off, the error of fitted paths.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  std::vector<std::string> notes_;
  Model model_;
  Mechanism mechanism_;
  CoordinateReduction reduction_;
  MusclePaths paths_;
  std::optional<FittedPaths> fit_;
  PathSource source_;
  MuscleGroup<double> muscles_;
  StateLayout layout_;
  std::vector<double> scales_;
};

/// What drives a system at an instant.
struct SystemInputs {
  std::span<const double> excitation;        ///< by muscle
  std::span<const double> coordinate_force;  ///< by coordinate, beside the model's own; empty: zero [N m or N]
};

/// The workspace of one thread: derivative of a state, and everything computed on the way. No call allocates.
template <typename Scalar>
class SystemEvaluator {
 public:
  explicit SystemEvaluator(const MusculoskeletalSystem& system) : SystemEvaluator(system, same_muscles(system)) {}
  /// With other muscle parameters, or parameters that carry derivatives: `system.muscles().with(parameters)`.
  SystemEvaluator(const MusculoskeletalSystem& system, MuscleGroup<Scalar> muscles);

  /// Values at which locked coordinates are held, by coordinate; other entries are not read.
  void hold(const Scalar* q);

  /// x' for the state x. False when the mass matrix is singular.
  [[nodiscard]] bool derivative(const Scalar* x, const SystemInputs& inputs, Scalar* rate);

  /// Positions and speeds, path lengths, speeds and gradients for free coordinates z; muscles are not evaluated.
  void set_motion(const Scalar* z, const Scalar* zdot);
  /// The same for q and qdot of all coordinates, constraints not heeded.
  void set_all(const Scalar* q, const Scalar* qdot);
  /// Sets activations (by muscle) and fibre lengths in equilibrium with their tendons at the pose set, in the state x.
  void start_muscles(const Scalar* activation, Scalar* x);

  // After a call above, in the model's order.
  [[nodiscard]] const Scalar* q() const { return q_; }
  [[nodiscard]] const Scalar* qdot() const { return qdot_; }
  [[nodiscard]] std::span<const Scalar> path_length() const { return length_; }
  [[nodiscard]] std::span<const Scalar> path_speed() const { return speed_; }
  /// dL/dq in the order of `system.pairs()`.
  [[nodiscard]] std::span<const Scalar> path_gradient() const { return gradient_; }
  [[nodiscard]] std::span<const Scalar> tendon_force() const { return force_; }
  [[nodiscard]] std::span<const Scalar> activation() const { return activation_; }
  [[nodiscard]] std::span<const Scalar> fiber_length() const { return fiber_; }
  [[nodiscard]] const MuscleGroup<Scalar>& muscles() const { return muscles_; }
  [[nodiscard]] ReducedDynamics<Scalar>& dynamics() { return reduced_; }
  /// Whether fitted paths were ever asked for a pose outside the ranges they were fitted over.
  [[nodiscard]] bool beyond_fit() const { return beyond_fit_; }
  /// Evaluations of the derivative so far.
  [[nodiscard]] long evaluations() const { return evaluations_; }

 private:
  static MuscleGroup<Scalar> same_muscles(const MusculoskeletalSystem& system);
  void update_paths();

  const MusculoskeletalSystem* system_;
  MuscleGroup<Scalar> muscles_;
  ReducedDynamics<Scalar> reduced_;
  PathWorkspace<Scalar> path_workspace_;
  std::vector<DrivenMotion<Scalar>> driven_;
  const Scalar* q_ = nullptr;
  const Scalar* qdot_ = nullptr;
  std::vector<Scalar> tau_;
  std::vector<Scalar> length_, speed_, gradient_;
  std::vector<Scalar> excitation_, activation_, fiber_, activation_rate_, fiber_velocity_, force_;
  long evaluations_ = 0;
  bool beyond_fit_ = false;
};

// Details ------------------------------------------------------------------------------------------------------------

template <typename Scalar>
MuscleGroup<Scalar> SystemEvaluator<Scalar>::same_muscles(const MusculoskeletalSystem& system) {
  if constexpr (std::is_same_v<Scalar, double>) {
    return system.muscles();
  } else {
    std::vector<MusculotendonParameters<Scalar>> parameters;
    for (std::size_t m = 0; m < system.muscles().size(); ++m) {
      parameters.push_back(system.muscles().settings(m).musculotendon.template cast<Scalar>());
    }
    return system.muscles().template with<Scalar>(parameters);
  }
}

template <typename Scalar>
SystemEvaluator<Scalar>::SystemEvaluator(const MusculoskeletalSystem& system, MuscleGroup<Scalar> muscles)
    : system_(&system),
      muscles_(std::move(muscles)),
      reduced_(system.mechanism(), system.reduction()),
      path_workspace_(system.paths()),
      tau_(system.coordinates()),
      length_(muscles_.size()),
      speed_(muscles_.size()),
      gradient_(system.pairs().size()),
      excitation_(muscles_.size()),
      activation_(muscles_.size()),
      fiber_(muscles_.size()),
      activation_rate_(muscles_.size()),
      fiber_velocity_(muscles_.size()),
      force_(muscles_.size()) {
  for (const DrivenMotion<double>& motion : system.reduction().default_motion()) {
    driven_.push_back({Scalar(motion.value), Scalar(0.0), Scalar(0.0)});
  }
}

template <typename Scalar>
void SystemEvaluator<Scalar>::hold(const Scalar* q) {
  const std::span<const int> driven = system_->reduction().driven();
  for (std::size_t i = 0; i < driven.size(); ++i) driven_[i].value = q[driven[i]];
}

template <typename Scalar>
void SystemEvaluator<Scalar>::update_paths() {
  const MusclePaths& paths = system_->paths();
  if (const FittedPaths* fit = system_->fit()) {
    beyond_fit_ |= !fit->evaluate(paths, reduced_.kinematics(), q_, path_workspace_, length_.data(), gradient_.data());
  } else {
    paths.evaluate(reduced_.kinematics(), q_, path_workspace_);
    std::copy(path_workspace_.length.begin(), path_workspace_.length.end(), length_.begin());
    std::copy(path_workspace_.gradient.begin(), path_workspace_.gradient.end(), gradient_.begin());
  }
  std::fill(speed_.begin(), speed_.end(), Scalar(0.0));
  const auto pairs = system_->pairs();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    speed_[static_cast<std::size_t>(pairs[i].muscle)] += gradient_[i] * qdot_[pairs[i].coordinate];
  }
}

template <typename Scalar>
void SystemEvaluator<Scalar>::set_motion(const Scalar* z, const Scalar* zdot) {
  reduced_.set_state(z, zdot, driven_.data());
  q_ = reduced_.state().q.data();
  qdot_ = reduced_.state().qdot.data();
  update_paths();
}

template <typename Scalar>
void SystemEvaluator<Scalar>::set_all(const Scalar* q, const Scalar* qdot) {
  reduced_.dynamics().set_state(q, qdot);
  q_ = q;
  qdot_ = qdot;
  update_paths();
}

template <typename Scalar>
bool SystemEvaluator<Scalar>::derivative(const Scalar* x, const SystemInputs& inputs, Scalar* rate) {
  ++evaluations_;
  const StateLayout& layout = system_->layout();
  set_motion(x, x + layout.free);
  const std::size_t muscles = muscles_.size();
  for (std::size_t m = 0; m < muscles; ++m) {
    excitation_[m] = Scalar(inputs.excitation[m]);
    activation_[m] = layout.activation[m] >= 0 ? x[layout.activation[m]] : excitation_[m];
    if (layout.fiber_length[m] >= 0) fiber_[m] = x[layout.fiber_length[m]];
  }
  muscles_.rates({excitation_, activation_, fiber_, length_, speed_}, {activation_rate_, fiber_velocity_, force_});
  if (inputs.coordinate_force.empty()) {
    std::fill(tau_.begin(), tau_.end(), Scalar(0.0));
  } else {
    for (std::size_t c = 0; c < tau_.size(); ++c) tau_[c] = Scalar(inputs.coordinate_force[c]);
  }
  const auto pairs = system_->pairs();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    tau_[static_cast<std::size_t>(pairs[i].coordinate)] -=
        force_[static_cast<std::size_t>(pairs[i].muscle)] * gradient_[i];
  }
  add_limit_forces<Scalar>(system_->model().limit_forces, q_, qdot_, tau_.data());
  for (std::size_t i = 0; i < layout.free; ++i) rate[i] = x[layout.free + i];
  if (!reduced_.forward_dynamics(tau_.data(), nullptr, rate + layout.free).usable()) return false;
  for (std::size_t m = 0; m < muscles; ++m) {
    if (layout.activation[m] >= 0) rate[layout.activation[m]] = activation_rate_[m];
    if (layout.fiber_length[m] >= 0) rate[layout.fiber_length[m]] = fiber_velocity_[m];
  }
  return true;
}

template <typename Scalar>
void SystemEvaluator<Scalar>::start_muscles(const Scalar* activation, Scalar* x) {
  const StateLayout& layout = system_->layout();
  for (std::size_t m = 0; m < muscles_.size(); ++m) {
    // As the activation dynamics: never below the least, never above 1.
    const Scalar least(muscles_.settings(m).minimum_activation);
    activation_[m] = activation[m] < least ? least : (activation[m] > 1.0 ? Scalar(1.0) : activation[m]);
    if (layout.activation[m] >= 0) x[layout.activation[m]] = activation_[m];
  }
  muscles_.equilibrium(activation_, length_, fiber_);
  for (std::size_t m = 0; m < muscles_.size(); ++m) {
    if (layout.fiber_length[m] >= 0) x[layout.fiber_length[m]] = fiber_[m];
  }
}

}  // namespace veridyn::muscle
