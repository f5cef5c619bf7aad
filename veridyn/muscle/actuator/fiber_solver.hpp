#pragma once

#include <span>
#include <vector>

#include "veridyn/muscle/actuator/muscle_group.hpp"

namespace veridyn::muscle {

/// Fibre lengths at a stage of an implicit step: the solutions of l = base + step l'(l), where l' is the muscle's fibre
/// velocity at the stage's activation and path length.
///
/// Each muscle is an equation by itself, in which l' falls with l: a stretched tendon pulls the fibre out, and a hardly
/// active fibre follows within a millisecond. That is what makes the system stiff. Solved by the secant method inside a
/// bracket, from where the last solution, extrapolated along path and base, says: two evaluations as a rule. Does not
/// allocate after construction.
class FiberSolver {
 public:
  explicit FiberSolver(std::size_t muscles) : muscle_(muscles) {}

  /// `fiber` [m] holds the bases and becomes the solution; `in.fiber_length` must be the same array. `out` belongs to
  /// the solution, its fibre velocities are (l - base)/step. Where the fibre would become shorter than its curves allow
  /// within the step it ends at its least length. Muscles with rigid tendons are evaluated as they are.
  /// @returns false where there is no solution: a length or velocity is not finite.
  [[nodiscard]] bool solve(const MuscleGroup<double>& muscles, double step, const MuscleInputs<double>& in,
                           std::span<double> fiber, const MuscleOutputs<double>& out);

 private:
  /// Of one muscle: the search, and the last solution with the slope of the fibre velocity there.
  struct Search {
    double base = 0.0, low = 0.0, high = 0.0, last = 0.0, last_residual = 0.0;
    bool done = false;
    bool known = false;  ///< whether there is a last solution
    double length = 0.0, velocity = 0.0, path = 0.0, slope = 0.0;
  };
  void begin(Search& s, double step, double path, double& fiber) const;
  [[nodiscard]] static double next(Search& s, double step, double length, double residual, double reach, int iteration);

  std::vector<Search> muscle_;
};

}  // namespace veridyn::muscle
