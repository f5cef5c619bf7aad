#include "veridyn/muscle/simulation/driven_integration.hpp"

namespace veridyn::muscle {

numerics::IntegrationEnd integrate_driven(SystemEvaluator<double>& evaluator, ControlsAtInstant& signals,
                                          SystemStepper& stepper, double& t, double* x, double end,
                                          const SystemStepper::OnStep& on_step) {
  const SystemStepper::Derivative derivative = [&](double time, double step, double* state, double* rate) {
    return evaluator.stage(step, state, signals.at(time), rate);
  };
  bool go_on = true;
  const SystemStepper::OnStep step = [&](double from, double to) { return go_on = on_step(from, to); };
  while (t < end && go_on) {
    const numerics::IntegrationEnd piece = stepper.advance(derivative, t, x, std::min(end, signals.piece_end(t)), step);
    if (piece != numerics::IntegrationEnd::kReached) return piece;
    signals.begin_piece(t);
    stepper.restart(true);
  }
  return numerics::IntegrationEnd::kReached;
}

}  // namespace veridyn::muscle
