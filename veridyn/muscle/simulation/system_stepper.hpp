#pragma once

#include <functional>
#include <variant>

#include "veridyn/muscle/simulation/musculoskeletal_system.hpp"
#include "veridyn/numerics/additive_runge_kutta.hpp"
#include "veridyn/numerics/dormand_prince.hpp"

namespace veridyn::muscle {

/// Steps a system's state, and its tangents, with error control. Fibres that are hardly active follow their tendons
/// within a millisecond, and an explicit method must not step over that whatever accuracy is wanted: where there are
/// fibre lengths, and steps may be longer than that, they are stepped implicitly (`numerics::AdditiveRungeKutta`), else
/// all is explicit (`numerics::DormandPrince`).
class SystemStepper {
 public:
  /// x' at (t, x), `step` 0; with `step` > 0 as `SystemEvaluator::stage`. False: there is none.
  using Derivative = std::function<bool(double t, double step, double* x, double* rate)>;
  /// After an accepted step from `begin` to `end`; false stops there.
  using OnStep = std::function<bool(double begin, double end)>;

  /// `control`: its tolerance is in units of `system.scales()`. `tangents` numbers for each state follow the states, as
  /// in `DormandPrince`.
  SystemStepper(const MusculoskeletalSystem& system, const numerics::StepControl& control, std::size_t tangents = 0);

  /// From `t` to `end`, as `DormandPrince::advance`.
  numerics::IntegrationEnd advance(const Derivative& f, double& t, double* x, double end, const OnStep& on_step);
  /// The derivative jumps here: forget what the last step left. `keep_step` keeps the size of the next one.
  void restart(bool keep_step = false);
  /// The state at `time` within the step that `on_step` was told of.
  void interpolate(double time, double* out) const;
  /// Accepted and rejected steps so far.
  [[nodiscard]] long steps() const;

 private:
  std::vector<double> scales_;
  numerics::StepControl control_;
  std::variant<numerics::DormandPrince<double>, numerics::AdditiveRungeKutta> method_;
};

}  // namespace veridyn::muscle
