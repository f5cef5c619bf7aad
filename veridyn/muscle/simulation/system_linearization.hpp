#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "veridyn/muscle/actuator/fiber_solver.hpp"
#include "veridyn/muscle/actuator/muscle_group.hpp"
#include "veridyn/muscle/dynamics/inverse_dynamics_derivatives.hpp"
#include "veridyn/muscle/dynamics/reduced_dynamics.hpp"
#include "veridyn/muscle/model/simulation_jet.hpp"
#include "veridyn/muscle/simulation/path_derivatives.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"

namespace veridyn::muscle {

/// In actuator/muscle_group_derivatives.cpp.
extern template class MuscleGroup<SimulationJet>;
/// `muscles.rates(in, out)`, compiled for speed.
void muscle_rates(const MuscleGroup<SimulationJet>& muscles, const MuscleInputs<SimulationJet>& in,
                  const MuscleOutputs<SimulationJet>& out);

/// That an unknown drives a number of a muscle: d(field)/d(unknown) = weight.
struct TangentForcing {
  /// For `field`: the muscle's excitation.
  static constexpr std::size_t kExcitation = kEstimableFields;

  std::size_t column = 0;  ///< of the tangents
  std::size_t muscle = 0;
  std::size_t field = 0;  ///< `estimable_field`, or kExcitation
  double weight = 1.0;    ///< of an excitation it may change with time
};

/// View of a system, which must outlive it: the derivative of a state x' = f(x, u, theta) together with its
/// linearisation, and products of the linearisation with tangents S = dx/dtheta, whose equation is
/// S' = (df/dx) S + df/dtheta.
///
/// The Jacobian is put together from its parts once for all unknowns: each muscle by itself on small jets, paths by
/// their second derivatives, the skeleton through its mass matrix, M dqddot = dtau - d(M qddot + h). A workspace for
/// one thread; no call but the constructor allocates.
class SystemLinearization {
 public:
  /// `parameters`, by muscle, in place of the system's own.
  SystemLinearization(const MusculoskeletalSystem& system, std::span<const MusculotendonParameters<double>> parameters,
                      std::vector<TangentForcing> forcings, std::size_t columns);

  /// Values at which locked coordinates are held, by coordinate.
  void hold(const double* q);
  /// The weights of forcings by excitations, du/dtheta at the instant: those of other fields are not changed.
  void set_weight(std::size_t forcing, double weight) { forcings_[forcing].weight = weight; }

  /// x' for the state x, and the linearisation there, without external loads. False when the mass matrix is singular.
  [[nodiscard]] bool derivative(const double* x, const SystemInputs& inputs, double* rate);
  /// The same for a stage of a step that is implicit in the fibre lengths, as `SystemEvaluator::stage`.
  [[nodiscard]] bool stage(double step, double* x, const SystemInputs& inputs, double* rate);
  /// S' after `derivative` or after `stage` with the same step: then rows of fibre lengths in S hold their base and
  /// become the solution too. S and S' have a row of `columns` numbers for each state.
  void tangent_rate(double step, double* S, double* rate) const;

  /// Sets activations and fibre lengths in equilibrium with their tendons for the pose and speeds in x, and their rows
  /// of S from those of the pose. `start`: activations by muscle. `follows_excitation`: they are the excitations, so
  /// that forcings by excitations move them too.
  void start_muscles(const double* start, bool follows_excitation, double* x, double* S);

  // After `derivative`, with a row of `columns` derivatives written to `row` from the tangents S.
  [[nodiscard]] double tendon_force(std::size_t muscle) const { return force_[muscle]; }
  void tendon_force_row(std::size_t muscle, const double* S, double* row) const;
  /// Of a rigid tendon what the path leaves [m].
  [[nodiscard]] double fiber_length(std::size_t muscle, const double* x) const;
  void fiber_length_row(std::size_t muscle, const double* S, double* row) const;
  /// Moment of all muscles about a coordinate, with those that couplers make follow it [N m or N].
  [[nodiscard]] double muscle_moment(int coordinate) const;
  void muscle_moment_row(int coordinate, const double* S, double* row) const;

  /// Derivatives that a muscle's jets give, in this order.
  enum Slot : std::size_t { kActivation, kFiber, kPath, kSpeed, kField };
  static constexpr std::size_t kSlots = kField + kEstimableFields + 1;
  /// By slot, of one muscle.
  struct MuscleSlots {
    double activation_rate[kSlots] = {}, fiber_velocity[kSlots] = {}, force[kSlots] = {};
  };

 private:
  using Matrix = InverseDynamicsDerivatives::Matrix;
  /// All muscles on jets whose directions are, for each muscle by itself, activation (or excitation), fibre length (or
  /// path speed), path length, and up to three of its numbers.
  struct Pass {
    MuscleGroup<SimulationJet> muscles;
    std::vector<std::array<std::size_t, 3>> field;  ///< by muscle; kNone: unused
  };
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

  void make_passes(std::span<const MusculotendonParameters<double>> parameters);
  void set_motion(const double* x);
  void set_paths();
  [[nodiscard]] bool solve_fibers(double step, double* x, const SystemInputs& inputs);
  [[nodiscard]] bool linearise(const double* x, const SystemInputs& inputs, double* rate);
  void evaluate_muscles(const double* x, const SystemInputs& inputs);
  [[nodiscard]] bool evaluate_skeleton(const SystemInputs& inputs, double* acceleration);
  void differentiate_residual();
  void differentiate_skeleton();
  void differentiate_skeleton_by_jets();
  void assemble();
  void add_force_tangent(std::size_t muscle, const double* S, double factor, double* row) const;
  [[nodiscard]] bool live(std::size_t muscle) const { return live_activation_[muscle] != 0; }

  const MusculoskeletalSystem* system_;
  std::size_t free_, columns_;
  std::vector<TangentForcing> forcings_;
  std::vector<char> live_activation_;
  std::vector<Pass> passes_;
  std::vector<MusculotendonParameters<double>> parameters_;

  ReducedDynamics<double> reduced_;
  ExpandedState<double> unit_speed_;  ///< its bias is d slope/dz
  std::vector<DrivenMotion<double>> driven_;
  std::unique_ptr<PathDerivatives> paths_;
  std::optional<InverseDynamicsDerivatives> closed_form_;
  struct JetSkeleton;
  std::shared_ptr<JetSkeleton> jets_;

  std::vector<SimulationJet> in_activation_, in_excitation_, in_fiber_, in_length_, in_speed_, out_activation_,
      out_velocity_, out_force_;
  std::vector<MuscleSlots> slots_;
  std::vector<double> activation_rate_, fiber_velocity_, force_;
  std::vector<double> path_speed_;
  MuscleGroup<double> muscles_;  ///< with the parameters
  FiberSolver fiber_solver_;
  PassiveWorkspace<double> passive_;
  std::vector<double> activation_, fiber_, solved_velocity_;
  Matrix arm_;                           ///< muscles x free: dL/dz
  Matrix force_z_, force_zd_, speed_z_;  ///< muscles x free
  Matrix velocity_z_;                    ///< muscles x free
  Eigen::VectorXd tau_, residual_tau_, qddot_, residual_, acceleration_;
  Matrix mass_, mass_inverse_, r_z_, r_zd_, acc_z_, acc_zd_;
  Matrix acc_force_;  ///< free x muscles
};

}  // namespace veridyn::muscle
