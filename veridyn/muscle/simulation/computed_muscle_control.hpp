#pragma once

#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/muscle/model/signals.hpp"
#include "veridyn/muscle/simulation/forward_simulation.hpp"
#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

namespace veridyn::muscle {

/// Options of computed muscle control, with the meaning and the defaults they have in OpenSim's tool.
struct ControlOptions {
  double begin = 0.0;  ///< [s]; the motion before it is not used
  double end = 1.0;
  double window = 0.010;  ///< controls are held over windows of this length [s]
  double kp = 100.0;      ///< position gain [1/s^2]
  double kv = 20.0;       ///< speed gain [1/s]
  double min_control = 0.02;
  double max_control = 1.0;
  double reserve_force = 1.0;            ///< optimal force of a coordinate's reserve [N m or N]; 0: no reserves
  std::vector<double> reserve_forces{};  ///< by coordinate instead; empty: the same for all
  double accuracy = 1e-5;                ///< of the integration
  double rate_Hz = 200.0;                ///< of the rows of the result; 0: the integrator's steps
};

/// A motion found by computed muscle control, and what reproduces it.
struct ControlResult {
  /// Where it starts: the desired pose and speeds at `begin`, muscles at rest at activations that balance the desired
  /// acceleration there.
  StartState start;
  /// Excitations and reserves, held over each window: `simulate_forward(system, start, controls, ...)` with the same
  /// accuracy repeats the motion to rounding.
  MuscleControls controls;
  MuscleTrajectory trajectory;
  estimation::RowMatrix desired;  ///< q of the motion to follow, rows as `trajectory`
  /// Windows in which the muscles could not produce the desired acceleration and the reserves had to exceed their
  /// optimal force.
  std::vector<double> overloaded;  ///< their beginnings [s]

  [[nodiscard]] bool usable() const { return trajectory.usable(); }
  /// Largest |q - desired| of a coordinate over the rows [rad or m].
  [[nodiscard]] double tracking_error(int coordinate) const;
};

/// Computed muscle control (Thelen & Anderson 2006): the excitations with which the muscles follow a motion.
///
/// In each window of length T: (1) desired accelerations qddot_ref(t + T) + kv (qdot_ref - qdot) + kp (q_ref - q), plus
/// what the last window fell short of in speed, over T (forces reach their desired value at the end of a window but
/// grow towards it late: without this the motion lags by a third of a window, as OpenSim's does); (2) the muscles
/// alone, along the reference path shifted by the present error, with least and greatest excitation: the forces they
/// can reach by t + T; (3) min sum (F/F_opt)^2 + sum (reserve/optimal)^2 subject to the desired accelerations and these
/// bounds, F_opt the active force along a rigid tendon at full activation; (4) for each muscle the constant excitation
/// that ends at its force; (5) the whole system over the window. Excitations are held over their window, and stay so in
/// the result: OpenSim writes them as samples to be interpolated, which is why a replay of its controls departs from
/// its motion.
///
/// Closed loops: (1) the nearest accelerations that keep them closed; (3) balanced along the motions that they allow,
/// whatever the loops carry. The start is assembled.
///
/// Locked coordinates are held where the motion, if it has them, is at `begin`; else at the model's default.
/// Every free coordinate must be in the motion. @throws InputError naming the one that is not, or options outside their
/// range.
[[nodiscard]] ControlResult computed_muscle_control(const MusculoskeletalSystem& system, const Motion& motion,
                                                    const ControlOptions& options, Progress& progress);

}  // namespace veridyn::muscle
