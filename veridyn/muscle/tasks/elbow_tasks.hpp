#pragma once

#include <string>
#include <vector>

#include "veridyn/muscle/tasks/task.hpp"

namespace veridyn::muscle {

/// The elbow tasks of the published method: which coordinates they move and hold, what the hand carries, how they are
/// followed.
struct ElbowTaskOptions {
  std::string elbow = {};      ///< coordinate that moves; empty: the only one with "elbow" in its name
  std::string shoulder = {};   ///< coordinate that is held; empty: the only one with "shoulder" in its name
  double load = 1.0;           ///< in the hand [kg]; 0: none
  std::string load_body = {};  ///< empty: the body that the elbow's joint moves
  /// In that body's frame [m]; none: the end of a uniform rod with its mass centre, twice as far as that is.
  std::optional<Eigen::Vector3d> load_location = {};
  double start = 0.03;    ///< before it the elbow rests: the muscle states settle [s]
  double duration = 1.0;  ///< of the movement [s]
  double rate_Hz = 100.0;
  ControlOptions control = {};
};

/// How many there are.
inline constexpr int kElbowTasks = 42;

/// Movement and pose of a task by its number, 1 to 42: direction outermost (flexion 1-21, extension 22-42), then the
/// shoulder at -90, -45, 0, 45, 90, 135, 180 deg, innermost the elbow's range 0-90, 0-130, 90-130 deg.
struct ElbowTask {
  double shoulder = 0.0;        ///< [rad]
  double from = 0.0, to = 0.0;  ///< of the elbow; extension starts at the larger angle [rad]
};
/// @throws InputError for a number that is not one of them.
[[nodiscard]] ElbowTask elbow_task(int number);
/// "task 4: flexion 0-90 deg, shoulder -45 deg".
[[nodiscard]] std::string elbow_task_name(int number);

/// The options with names and places as the model has them.
/// @throws InputError when the model has no such coordinate or body, or several that could be meant, naming them.
[[nodiscard]] ElbowTaskOptions resolved(const Model& model, ElbowTaskOptions options);

/// Why a model cannot perform an elbow task: an angle outside its range; empty: it can. `options` resolved.
[[nodiscard]] std::string obstacle(const Model& model, const ElbowTaskOptions& options, int number);

/// The task of that number: half-sine ramp of the elbow after `start`, everything else at rest where the model has it
/// by default. `options` resolved. @throws InputError with `obstacle`.
[[nodiscard]] Task make_elbow_task(const Model& model, const ElbowTaskOptions& options, int number);

}  // namespace veridyn::muscle
