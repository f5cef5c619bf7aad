#include "veridyn/vehicle/tracking/axle_curve.hpp"

#include <algorithm>
#include <cmath>

namespace veridyn::vehicle {
namespace {

/// Times the slip without a limit that is looked for.
constexpr double kMostSlip = 2.0;
constexpr int kHalvings = 40;

}  // namespace

bool is_linear(const AnyRollingBicycle& vehicle) {
  return std::holds_alternative<RollingBicycle<double, LinearTyre<double>>>(vehicle);
}

std::array<double, 2> stiffnesses_of(const AnyRollingBicycle& vehicle) {
  return std::visit(
      [](const auto& model) {
        return std::array{model.bicycle.parameters.C_f, model.bicycle.parameters.C_r};
      },
      vehicle);
}

std::array<double, 2> forces_without_limit(const AnyRollingBicycle& vehicle, const std::array<double, 2>& force,
                                           double shifted) {
  if (is_linear(vehicle)) return force;
  return std::visit(
      [&](const auto& model) {
        const VehicleParameters<double>& p = model.bicycle.parameters;
        const std::array<double, 2> stiffness{p.C_f, p.C_r};
        const Eigen::Vector4d state(0.0, 0.0, shifted, 0.0);
        std::array<double, 2> low{}, high{};
        for (std::size_t i = 0; i < 2; ++i) {
          low[i] = std::abs(force[i]) / stiffness[i];
          high[i] = kMostSlip * low[i];
        }
        // Force over slip rises from below to above on the way; both axles at once, as the model gives both.
        for (int k = 0; k < kHalvings; ++k) {
          const std::array middle{0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])};
          const std::array<double, 2> pushed = model.template axle_forces<4>(middle, state);
          for (std::size_t i = 0; i < 2; ++i) (pushed[i] < std::abs(force[i]) ? low[i] : high[i]) = middle[i];
        }
        std::array<double, 2> out{};
        for (std::size_t i = 0; i < 2; ++i) out[i] = std::copysign(stiffness[i] * 0.5 * (low[i] + high[i]), force[i]);
        return out;
      },
      vehicle);
}

}  // namespace veridyn::vehicle
