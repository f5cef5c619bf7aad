#include "veridyn/muscle/actuator/fiber_solver.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::muscle {

/// The last solution, moved along path and base by the slopes there. Tendons are stiffer than all else: a longer path
/// does to the fibre velocity what a shorter fibre does.
void FiberSolver::begin(Search& s, double step, double path, double& fiber) const {
  s.base = fiber;
  s.low = -kInfinity;
  s.high = kInfinity;
  s.done = false;
  if (s.known) fiber = (s.base + step * (s.velocity - s.slope * (s.length + path - s.path))) / (1.0 - step * s.slope);
}

double FiberSolver::next(Search& s, double step, double length, double residual, double reach, int iteration) {
  (residual < 0.0 ? s.low : s.high) = length;
  double slope = 1.0 - step * s.slope;
  if (iteration > 0 && length != s.last) {
    const double secant = (residual - s.last_residual) / (length - s.last);
    constexpr double kLeastSecant = 0.1;  // steps are far shorter than what would make it less
    if (secant > kLeastSecant) {
      slope = secant;
      s.slope = (1.0 - secant) / step;
    }
  }
  s.last = length;
  s.last_residual = residual;
  constexpr int kSecants = 8;
  const double to = length + std::clamp(-residual / slope, -reach, reach);
  if (!std::isfinite(s.low) || !std::isfinite(s.high)) return to;
  if (to >= s.low && to <= s.high && iteration <= kSecants) return to;
  return 0.5 * (s.low + s.high);
}

bool FiberSolver::solve(const MuscleGroup<double>& muscles, double step, const MuscleInputs<double>& in,
                        std::span<double> fiber, const MuscleOutputs<double>& out) {
  bool searching = false;
  for (std::size_t m = 0; m < muscle_.size(); ++m) {
    muscle_[m].done = !muscles.has_fiber_state(m);
    if (muscle_[m].done) continue;
    begin(muscle_[m], step, in.path_length[m], fiber[m]);
    searching = true;
  }
  constexpr int kMaxIterations = 100;
  for (int iteration = 0; searching; ++iteration) {
    if (iteration == kMaxIterations) return false;
    muscles.rates(in, out);
    searching = false;
    for (std::size_t m = 0; m < muscle_.size(); ++m) {
      Search& s = muscle_[m];
      if (s.done) continue;
      const double length = fiber[m], velocity = out.fiber_velocity[m], residual = length - s.base - step * velocity;
      if (!std::isfinite(residual)) return false;
      s.known = true;
      s.length = length;
      s.velocity = velocity;
      s.path = in.path_length[m];
      const double optimal = muscles.settings(m).musculotendon.optimal_fiber_length;
      fiber[m] = next(s, step, length, residual, 0.2 * optimal, iteration);
      // A secant's error is far below its step; a bracket closes around the least length, where the velocity jumps.
      s.done = std::abs(fiber[m] - length) <= 1e-7 * optimal;
      searching = searching || !s.done;
    }
  }
  muscles.tendon_forces(in, out.tendon_force);
  for (std::size_t m = 0; m < muscle_.size(); ++m) {
    if (muscles.has_fiber_state(m)) out.fiber_velocity[m] = (fiber[m] - muscle_[m].base) / step;
  }
  return true;
}

}  // namespace veridyn::muscle
