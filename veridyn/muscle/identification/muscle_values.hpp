#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "veridyn/muscle/actuator/muscle_group.hpp"
#include "veridyn/muscle/identification/muscle_unknowns.hpp"

namespace veridyn::muscle {

/// Parameters of all muscles and of their excitations at values of the unknowns.
struct MuscleValues {
  std::vector<MusculotendonParameters<double>> muscles;
  std::vector<double> gain, delay;  ///< by muscle [1], [s]

  /// The number that a name means.
  [[nodiscard]] double& at_name(const MuscleParameterName& name);
  /// Whether muscles can have these parameters: bounds of a search keep estimates inside, a step beyond them must not
  /// crash.
  [[nodiscard]] bool possible() const;
};

/// Those of `muscles` with the unknowns at theta, whose first entries are the unknowns.
[[nodiscard]] MuscleValues values_at(const MuscleGroup<double>& muscles, std::span<const MuscleUnknown> unknowns,
                                     const Eigen::VectorXd& theta);

}  // namespace veridyn::muscle
