#pragma once

#include <algorithm>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/simulation/forward_simulation.hpp"
#include "veridyn/muscle/simulation/system_evaluator.hpp"
#include "veridyn/muscle/simulation/system_stepper.hpp"

namespace veridyn::muscle {

/// View of controls, which must outlive it: their excitations and reserves at an instant. Held signals keep the value
/// that `begin_piece` found until the piece ends.
class ControlsAtInstant {
 public:
  ControlsAtInstant(const MuscleControls& controls, std::size_t muscles, std::size_t coordinates)
      : controls_(controls), excitation_(muscles), reserve_(controls.reserve.size() > 0 ? coordinates : 0) {}

  void begin_piece(double time) {
    controls_.excitation.evaluate(time, excitation_.data());
    if (!reserve_.empty()) controls_.reserve.evaluate(time, reserve_.data());
  }
  /// The first instant after `time` at which a held signal jumps; infinite when there is none.
  [[nodiscard]] double piece_end(double time) const {
    double end = kInfinity;
    for (const ControlSignals* signals : {&controls_.excitation, &controls_.reserve}) {
      if (signals->interpolation() == Interpolation::kHold) end = std::min(end, signals->next_break(time));
    }
    return end;
  }
  [[nodiscard]] SystemInputs at(double time) {
    if (controls_.excitation.interpolation() == Interpolation::kLinear)
      controls_.excitation.evaluate(time, excitation_.data());
    if (!reserve_.empty() && controls_.reserve.interpolation() == Interpolation::kLinear) {
      controls_.reserve.evaluate(time, reserve_.data());
    }
    return {excitation_, reserve_, controls_.external.get(), time};
  }

 private:
  const MuscleControls& controls_;
  std::vector<double> excitation_, reserve_;
};

/// Integrates the state `x` of a driven system from `t` to `end`, piece by piece between the instants at which held
/// signals jump; `signals.begin_piece(t)` was called before. After each step `on_step(begin, end)` is called, which may
/// interpolate states by the stepper and returns false to stop.
/// @returns kReached also when `on_step` stopped it; then t < end.
numerics::IntegrationEnd integrate_driven(SystemEvaluator<double>& evaluator, ControlsAtInstant& signals,
                                          SystemStepper& stepper, double& t, double* x, double end,
                                          const SystemStepper::OnStep& on_step);

}  // namespace veridyn::muscle
