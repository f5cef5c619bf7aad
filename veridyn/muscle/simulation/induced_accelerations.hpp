#pragma once

#include <string>
#include <vector>

#include "veridyn/estimation/regression/regression_data.hpp"
#include "veridyn/muscle/simulation/joint_reactions.hpp"
#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"

namespace veridyn::muscle {

/// What each force contributes to the accelerations of the coordinates (Zajac & Gordon 1989, Exerc Sport Sci Rev
/// 17:187). Rows are instants, columns the sources.
struct InducedAccelerations {
  /// Muscles by name; then "gravity", "velocity" (centripetal and Coriolis terms, the motion of couplers and loops),
  /// "passive" (springs, limits, contacts, ligaments), "reserves", "external", where there are any.
  std::vector<std::string> sources;
  std::vector<int> coordinates;             ///< free ones, in the model's order
  std::vector<estimation::RowMatrix> part;  ///< by those [rad/s^2 or m/s^2]
};

/// Contributions of the forces that `moved` has; `moved.qddot` is not read. The equations of motion are linear in
/// forces, so that the contributions add up to the accelerations: each is that of the one force in the pose, through
/// couplers, locked coordinates and closed loops. Contacts are forces here: what the ground answers to a muscle within
/// the instant is not among the muscle's part.
[[nodiscard]] InducedAccelerations induced_accelerations(const MusculoskeletalSystem& system, const MovedModel& moved);

}  // namespace veridyn::muscle
