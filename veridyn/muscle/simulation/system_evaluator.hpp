#pragma once

#include <concepts>
#include <span>
#include <vector>

#include "veridyn/muscle/actuator/fiber_solver.hpp"
#include "veridyn/muscle/actuator/muscle_group.hpp"
#include "veridyn/muscle/dynamics/reduced_dynamics.hpp"
#include "veridyn/muscle/model/external_load.hpp"
#include "veridyn/muscle/path/path_workspace.hpp"
#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

namespace veridyn::muscle {

/// View of what drives a system at an instant: valid while the arrays that it names are.
struct SystemInputs {
  std::span<const double> excitation;        ///< by muscle
  std::span<const double> coordinate_force;  ///< by coordinate, in addition to the model's; empty: zero [N m or N]
  const ExternalLoads* external = nullptr;   ///< forces of the surroundings; null: none
  double time = 0.0;                         ///< at which they are taken [s]
};

/// View of a system, which must outlive it: the workspace of one thread for the derivative of a state and everything
/// that is computed for it. No call allocates. Compiled for double and `SimulationJet`.
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
  /// The same for a stage of a step that is implicit in the fibre lengths: in x they hold their base and become the
  /// solutions of l = base + step l'(x), to which `rate` belongs. False also when there is none. With `step` 0 as
  /// `derivative`.
  [[nodiscard]] bool stage(double step, double* x, const SystemInputs& inputs,
                           double* rate) requires std::same_as<Scalar, double>;

  /// Positions and speeds, path lengths, speeds and gradients for free coordinates z; muscles are not evaluated.
  void set_motion(const Scalar* z, const Scalar* zdot);
  /// The same for a pose and speeds of all coordinates, of which the free ones and the values of the locked ones are
  /// taken.
  void set_pose(const Scalar* q, const Scalar* qdot);
  /// The same for q and qdot of all coordinates, without regard to constraints. Both arrays must stay while results are
  /// read.
  void set_all(const Scalar* q, const Scalar* qdot);
  /// Sets activations (by muscle) and fibre lengths in equilibrium with their tendons at the pose set, in the state x.
  void start_muscles(const Scalar* activation, Scalar* x);

  /// Adds the generalised forces that follow from the motion set: springs, limits, contact, passive paths.
  void add_passive_forces(Scalar* tau);
  /// Adds those of the surroundings at a time; nothing when `loads` is null.
  void add_external_forces(const ExternalLoads* loads, double time, Scalar* tau);

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
  /// Evaluations of the derivative so far.
  [[nodiscard]] long evaluations() const { return evaluations_; }

 private:
  static MuscleGroup<Scalar> same_muscles(const MusculoskeletalSystem& system);
  void update_paths();
  /// Inputs and states of the muscles from x, whose motion is set.
  void read_muscles(const Scalar* x, const SystemInputs& inputs);
  /// x' from the muscles' rates and forces.
  [[nodiscard]] bool write_rates(const Scalar* x, const SystemInputs& inputs, Scalar* rate);

  const MusculoskeletalSystem* system_;
  MuscleGroup<Scalar> muscles_;
  ReducedDynamics<Scalar> reduced_;
  PathWorkspace<Scalar> path_workspace_;
  PassiveWorkspace<Scalar> passive_;
  std::vector<DrivenMotion<Scalar>> driven_;
  std::vector<Scalar> free_q_, free_qdot_;  ///< of `set_pose`
  const Scalar* q_ = nullptr;
  const Scalar* qdot_ = nullptr;
  std::vector<Scalar> tau_;
  std::vector<Scalar> length_, speed_, gradient_;
  std::vector<Scalar> excitation_, activation_, fiber_, activation_rate_, fiber_velocity_, force_;
  FiberSolver fiber_solver_;
  long evaluations_ = 0;
};

}  // namespace veridyn::muscle
