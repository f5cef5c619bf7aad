#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/regression/regression_data.hpp"
#include "veridyn/muscle/model/external_load.hpp"
#include "veridyn/muscle/model/signals.hpp"
#include "veridyn/muscle/simulation/assembly.hpp"
#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

namespace veridyn::muscle {

/// Where a simulation starts.
struct StartState {
  Eigen::VectorXd q;           ///< all coordinates [rad or m]
  Eigen::VectorXd qdot;        ///< all coordinates [1/s]
  Eigen::VectorXd activation;  ///< by muscle; empty: the excitation at the start
  /// By muscle [m]; empty: each in equilibrium with its tendon.
  Eigen::VectorXd fiber_length;
};

/// The model's default pose and speeds.
[[nodiscard]] StartState default_start(const Model& model);

/// What `simulate_forward` integrates over, and how accurately.
struct ForwardOptions {
  double begin = 0.0;      ///< [s]
  double end = 1.0;        ///< [s]
  double rate_Hz = 200.0;  ///< of the rows of the result; 0: a row at each step of the integrator
  /// Largest error of a step in units of `MusculoskeletalSystem::scales`; OpenSim's tools take 1e-5 for theirs.
  double accuracy = 1e-5;
  long max_steps = 1000000;
};

/// A muscle that reached a limit of its model, or left it.
struct MuscleEvent {
  double time = 0.0;  ///< [s]
  int muscle = 0;     ///< in the model's order
  enum class Kind { kTendonSlack, kTendonTaut, kFiberShortest, kFiberFree } kind = Kind::kTendonSlack;
};
/// What happened, for tables: "tendon goes slack".
[[nodiscard]] std::string event_text(MuscleEvent::Kind kind);

/// Why a simulated motion ended.
enum class MotionEnd {
  kCompleted,    ///< simulated to the end
  kInterrupted,  ///< the caller's progress asked to stop
  kDiverged,     ///< the state became NaN or infinite, or left every sensible range
  kStepSize,     ///< no step is small enough: a limit of the model
  kStepLimit,    ///< the largest number of steps is used up
};

/// A motion with its muscles, a row a sample. Matrices are samples x coordinates or samples x muscles.
struct MuscleTrajectory {
  std::vector<double> time;  ///< [s]
  estimation::RowMatrix q, qdot;
  estimation::RowMatrix excitation, activation;
  estimation::RowMatrix fiber_length;  ///< [m]; of a rigid tendon what the path leaves
  estimation::RowMatrix tendon_force;  ///< [N]
  estimation::RowMatrix path_length;   ///< [m]
  estimation::RowMatrix reserve;       ///< extra generalised forces, samples x coordinates [N m or N]
  std::vector<MuscleEvent> events;
  MotionEnd end = MotionEnd::kCompleted;
  double end_time = 0.0;
  long steps = 0;
  long evaluations = 0;
  std::string trouble;  ///< unless it completed: which state caused the end
  Eigen::VectorXd final_state;
  Assembly assembly;  ///< of the start, with its loops closed

  [[nodiscard]] bool usable() const { return end == MotionEnd::kCompleted; }
  /// How it ended, and when.
  [[nodiscard]] std::string message() const;
};

/// "elbow_flexion is 2.1e4": the state that is largest in units of its scale, or the first that is no number.
[[nodiscard]] std::string largest_state(const MusculoskeletalSystem& system, const double* x);

/// What drives a simulation.
struct MuscleControls {
  ControlSignals excitation;  ///< by muscle
  /// Generalised forces by coordinate, such as the reserves of computed muscle control; none when empty.
  ControlSignals reserve;
  /// Forces of the surroundings; null: none.
  std::shared_ptr<const ExternalLoads> external = {};
};

/// Integrates the system from `start`, with its loops closed (`assemble`), with error control (`SystemStepper`).
/// Instants at which held signals jump are ends of steps. Slack tendons and shortest fibres are located as events.
/// Never throws on a diverging simulation and always ends: the result says how.
/// @throws InputError for a start that is not finite or outside a coordinate's range, naming the coordinate, or whose
/// loops cannot be closed.
[[nodiscard]] MuscleTrajectory simulate_forward(const MusculoskeletalSystem& system, const StartState& start,
                                                const MuscleControls& controls, const ForwardOptions& options,
                                                Progress& progress);

}  // namespace veridyn::muscle
