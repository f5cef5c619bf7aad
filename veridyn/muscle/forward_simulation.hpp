#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/regression_data.hpp"
#include "veridyn/muscle/musculoskeletal_system.hpp"
#include "veridyn/muscle/signals.hpp"

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

struct ForwardOptions {
  double begin = 0.0;
  double end = 1.0;
  double rate_Hz = 200.0;  ///< of the rows of the result
  /// Largest error of a step in units of `MusculoskeletalSystem::scales`; OpenSim's tools take 1e-5 for their own norm.
  double accuracy = 1e-5;
  long max_steps = 1000000;
};

enum class SimulationEnd {
  kCompleted,
  kDiverged,     ///< a state became infinite, or a coordinate went beyond 1e4 rad or m
  kStepSize,     ///< no step is small enough: a muscle or a joint at a limit of its model
  kStepLimit,    ///< `max_steps` used up
  kInterrupted,  ///< the caller asked to stop
};

/// A muscle that reached a limit of its model, or left it.
struct MuscleEvent {
  double time = 0.0;
  int muscle = 0;
  enum class Kind { kTendonSlack, kTendonTaut, kFiberShortest, kFiberFree } kind = Kind::kTendonSlack;
};
[[nodiscard]] std::string event_text(MuscleEvent::Kind kind);

/// A motion with its muscles, a row a sample. Matrices are samples x coordinates or samples x muscles.
struct MuscleTrajectory {
  std::vector<double> time;  ///< [s]
  estimation::RowMatrix q, qdot;
  estimation::RowMatrix excitation, activation;
  estimation::RowMatrix fiber_length;  ///< [m]; of a rigid tendon what the path leaves
  estimation::RowMatrix tendon_force;  ///< [N]
  estimation::RowMatrix path_length;   ///< [m]
  /// Generalised forces that held or helped: of locked and prescribed coordinates zero; of reserves in CMC [N m or N].
  estimation::RowMatrix reserve;
  std::vector<MuscleEvent> events;
  SimulationEnd end = SimulationEnd::kCompleted;
  double end_time = 0.0;
  long steps = 0;
  long evaluations = 0;
  std::string trouble;  ///< which state, when it did not complete
  Eigen::VectorXd final_state;

  [[nodiscard]] bool usable() const { return end == SimulationEnd::kCompleted; }
  [[nodiscard]] std::string message() const;
};

/// Integrates the system from `start` under `excitation`, with the error-controlled Dormand-Prince method. Instants at
/// which held controls jump are ends of steps. Slack tendons and shortest fibres are located on the way as events.
/// Never throws on a diverging simulation and always ends: the result says how.
/// @throws InputError for a start outside a clamped coordinate's range or with NaN, naming the coordinate.
[[nodiscard]] MuscleTrajectory simulate_forward(const MusculoskeletalSystem& system, const StartState& start,
                                                const ControlSignals& excitation, const ForwardOptions& options,
                                                Progress& progress);

/// The same with extra generalised forces (by coordinate) as functions of time, such as the reserves of CMC.
[[nodiscard]] MuscleTrajectory simulate_forward(const MusculoskeletalSystem& system, const StartState& start,
                                                const ControlSignals& excitation, const ControlSignals& reserve,
                                                const ForwardOptions& options, Progress& progress);

}  // namespace veridyn::muscle
