#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/muscle/coordinate_forces.hpp"
#include "veridyn/muscle/coordinate_reduction.hpp"
#include "veridyn/muscle/dynamics.hpp"
#include "veridyn/muscle/mechanism.hpp"
#include "veridyn/muscle/model.hpp"
#include "veridyn/muscle/muscle_group.hpp"
#include "veridyn/muscle/muscle_path.hpp"
#include "veridyn/muscle/path_fit.hpp"

namespace veridyn::muscle {

/// Where path lengths and moment arms come from.
enum class PathSource {
  kExact,     ///< wrapping, computed at every pose
  kFitted,    ///< polynomials fitted to it once: several times faster, with a stated error
  kAsOpenSim  ///< OpenSim's own wrapping, jumps included, for comparisons; no derivatives
};

struct SystemOptions {
  PathSource paths = PathSource::kExact;
  PathFitOptions fit;
  /// Coordinates held at their default or start value, beside those the model locks.
  std::vector<std::string> locked;
  /// Coordinates that the model locks and that move all the same.
  std::vector<std::string> unlocked;
  /// Go on although forces or constraints of the model are not understood.
  bool without_unsupported = false;
};

/// Where the states of a system stand in its state vector: free coordinates [rad or m], their speeds, activations of
/// the muscles that have one, fibre lengths [m] of the muscles that have one.
struct StateLayout {
  std::size_t free_coordinates = 0;
  std::vector<int> activation;    ///< by muscle; -1: the excitation is the activation
  std::vector<int> fiber_length;  ///< by muscle; -1: the tendon is rigid
  std::size_t size = 0;

  [[nodiscard]] std::size_t speed(std::size_t free) const { return free_coordinates + free; }
};

/// A model made ready for dynamics: tree, constraints, paths, muscles. Immutable; used by many threads at once, each
/// with its own `SystemEvaluator`.
class MusculoskeletalSystem {
 public:
  /// @throws InputError naming element and reason: unsupported forces, unknown coordinates, a path point inside a wrap
  /// object at the default pose, singular inertia.
  MusculoskeletalSystem(Model model, const SystemOptions& options = {});

  [[nodiscard]] const Model& model() const { return model_; }
  [[nodiscard]] const Mechanism& mechanism() const { return mechanism_; }
  [[nodiscard]] const CoordinateReduction& reduction() const { return reduction_; }
  [[nodiscard]] const MusclePaths& paths() const { return paths_; }
  /// Null unless paths are fitted.
  [[nodiscard]] const PathFit* fit() const { return fit_ ? &*fit_ : nullptr; }
  [[nodiscard]] PathSource path_source() const { return source_; }
  [[nodiscard]] const MuscleGroup<double>& muscles() const { return muscles_; }
  [[nodiscard]] const CoordinateForces& coordinate_forces() const { return forces_; }
  [[nodiscard]] const StateLayout& layout() const { return layout_; }
  [[nodiscard]] std::size_t coordinates() const { return model_.coordinates.size(); }
  /// Sizes of the states, for error control: 1 rad or m, 10 per second, activation 1, fibre length L0.
  [[nodiscard]] std::span<const double> scales() const { return scales_; }
  /// What a user should know of it: the fit's error, coordinates held.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  Model model_;
  Mechanism mechanism_;
  CoordinateReduction reduction_;
  MusclePaths paths_;
  std::optional<PathFit> fit_;
  PathSource source_;
  MuscleGroup<double> muscles_;
  CoordinateForces forces_;
  StateLayout layout_;
  std::vector<double> scales_;
  std::vector<std::string> notes_;
};

/// What drives a system at an instant.
struct SystemInputs {
  std::span<const double> excitation;         ///< by muscle
  std::span<const double> actuator;           ///< controls of the coordinate actuators; empty: zero
  std::span<const double> coordinate_force;   ///< by coordinate, in addition [N m or N]; empty: zero
};

/// The workspace of one thread: derivative of a state, and everything computed on the way. No call allocates.
template <typename Scalar>
class SystemEvaluator {
 public:
  /// `muscles` (as many as the system's) replace the system's own: other parameters, or parameters with derivatives.
  explicit SystemEvaluator(const MusculoskeletalSystem& system);
  SystemEvaluator(const MusculoskeletalSystem& system, MuscleGroup<Scalar> muscles);

  /// x' for the state x. False when the mass matrix is singular or something is not finite.
  [[nodiscard]] bool derivative(const Scalar* x, const SystemInputs& inputs, Scalar* rate);

  /// Positions alone: q of all coordinates, kinematics, path lengths and their derivatives for free coordinates z.
  void set_pose(const Scalar* z);
  /// Positions and speeds, without muscles and accelerations.
  void set_motion(const Scalar* z, const Scalar* zdot);
  /// The same for given q and qdot of all coordinates, constraints not heeded.
  void set_all_coordinates(const Scalar* q, const Scalar* qdot);

  /// The state at rest of the muscles: `activation` by muscle, fibres in equilibrium at the pose set.
  void start_muscles(const Scalar* activation, Scalar* x);

  // After a call above, in the model's order.
  [[nodiscard]] std::span<const Scalar> q() const { return q_; }
  [[nodiscard]] std::span<const Scalar> qdot() const { return qdot_; }
  [[nodiscard]] std::span<const Scalar> path_length() const { return length_; }
  [[nodiscard]] std::span<const Scalar> path_speed() const { return speed_; }
  /// dL/dq in the order of `system.paths().pairs()`.
  [[nodiscard]] std::span<const Scalar> path_gradient() const { return gradient_; }
  [[nodiscard]] std::span<const Scalar> tendon_force() const { return force_; }
  [[nodiscard]] std::span<const Scalar> fiber_velocity() const { return fiber_velocity_; }
  [[nodiscard]] std::span<const Scalar> activation() const { return activation_; }
  [[nodiscard]] std::span<const Scalar> fiber_length() const { return fiber_; }
  [[nodiscard]] const MuscleGroup<Scalar>& muscles() const { return muscles_; }
  [[nodiscard]] Dynamics<Scalar>& dynamics() { return dynamics_; }
  /// Evaluations of the derivative so far.
  [[nodiscard]] long evaluations() const { return evaluations_; }

 private:
  void update_paths();
  void gather_muscle_states(const Scalar* x, const SystemInputs& inputs);

  const MusculoskeletalSystem* system_;
  MuscleGroup<Scalar> muscles_;
  Dynamics<Scalar> dynamics_;
  ReducedDynamics<Scalar> reduced_;
  PathWorkspace<Scalar> path_workspace_;
  std::vector<Scalar> q_, qdot_, tau_;
  std::vector<Scalar> length_, speed_, gradient_, excitation_, activation_, fiber_, activation_rate_, fiber_velocity_, force_;
  long evaluations_ = 0;
};

}  // namespace veridyn::muscle
