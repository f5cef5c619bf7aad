#include "veridyn/muscle/simulation/system_stepper.hpp"

namespace veridyn::muscle {
namespace {

using Method = std::variant<numerics::DormandPrince<double>, numerics::AdditiveRungeKutta>;

/// Below it steps are so short that explicit ones, of higher order, take less time.
constexpr double kFinestImplicit = 1e-6;
/// The implicit method estimates the error of a third-order solution, and with stiff parts it is smaller by more than
/// an order: with ten times the tolerance for all but activations, which are not stiff, angles and forces end as near
/// to the true ones as the explicit method's.
constexpr double kPessimism = 10.0;

Method method_for(const StateLayout& layout, double tolerance, std::size_t tangents) {
  std::vector<char> stiff(layout.size, 0);
  bool any = false;
  for (const int l : layout.fiber_length) {
    if (l < 0) continue;
    stiff[l] = 1;
    any = true;
  }
  if (any && tolerance >= kFinestImplicit) return numerics::AdditiveRungeKutta(std::move(stiff), tangents);
  return numerics::DormandPrince<double>(layout.size, tangents);
}

}  // namespace

SystemStepper::SystemStepper(const MusculoskeletalSystem& system, const numerics::StepControl& control,
                             std::size_t tangents)
    : scales_(system.scales().begin(), system.scales().end()),
      control_(control),
      method_(method_for(system.layout(), control.tolerance, tangents)) {
  if (!std::holds_alternative<numerics::AdditiveRungeKutta>(method_)) return;
  control_.tolerance *= kPessimism;
  for (const int a : system.layout().activation) {
    if (a >= 0) scales_[a] /= kPessimism;
  }
}

numerics::IntegrationEnd SystemStepper::advance(const Derivative& f, double& t, double* x, double end,
                                                const OnStep& on_step) {
  if (auto* implicit = std::get_if<numerics::AdditiveRungeKutta>(&method_))
    return implicit->advance(f, t, x, end, scales_, control_, on_step);
  const auto derivative = [&](double time, double* state, double* rate) { return f(time, 0.0, state, rate); };
  return std::get<numerics::DormandPrince<double>>(method_).advance(derivative, t, x, end, scales_, control_, on_step);
}

void SystemStepper::restart(bool keep_step) {
  std::visit([&](auto& method) { method.restart(keep_step); }, method_);
}

void SystemStepper::interpolate(double time, double* out) const {
  std::visit([&](const auto& method) { method.interpolate(time, out); }, method_);
}

long SystemStepper::steps() const {
  return std::visit([](const auto& method) { return method.steps(); }, method_);
}

}  // namespace veridyn::muscle
