#include "veridyn/vehicle/simulation/steady_turn.hpp"

#include <cmath>
#include <cstddef>

namespace veridyn::vehicle {

TurnSamples steady_turn(const VehicleTrajectory& t, double wheelbase, double begin) {
  TurnSamples turn;
  const bool rolls = t.roll.size() == t.size();
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double speed = std::hypot(t.u[i], t.v[i]), centripetal = speed * t.r[i];
    if (!(t.time[i] >= begin && speed > 0.0)) continue;
    const double sign = centripetal < 0.0 ? -1.0 : 1.0;
    turn.acceleration.push_back(std::abs(centripetal));
    turn.extra_steer.push_back(sign * (t.steer[i] - wheelbase * t.r[i] / speed));
    turn.sideslip.push_back(sign * std::atan2(t.v[i], t.u[i]));
    if (rolls) turn.roll.push_back(sign * t.roll[i]);
  }
  return turn;
}

double steady_turn_begin(const Manoeuvre& manoeuvre) {
  if (manoeuvre.kind == ManoeuvreKind::kSteadyStateCircle && manoeuvre.radius != 0.0)
    return 0.15 * manoeuvre.default_duration;
  const bool turns = manoeuvre.kind == ManoeuvreKind::kSteadyStateCircle || manoeuvre.kind == ManoeuvreKind::kRampSteer;
  return turns ? 0.0 : kInfinity;
}

TurnGradient turn_gradient(std::span<const double> acceleration, std::span<const double> shown, double low,
                           double high) {
  const auto in_range = [&](std::size_t i) { return acceleration[i] >= low && acceleration[i] <= high; };
  double n = 0.0, mean_x = 0.0, mean_y = 0.0;
  for (std::size_t i = 0; i < acceleration.size(); ++i) {
    if (!in_range(i)) continue;
    n += 1.0;
    mean_x += acceleration[i];
    mean_y += shown[i];
  }
  if (n < 3.0) return {};
  mean_x /= n;
  mean_y /= n;
  double xx = 0.0, xy = 0.0;
  for (std::size_t i = 0; i < acceleration.size(); ++i) {
    if (!in_range(i)) continue;
    xx += (acceleration[i] - mean_x) * (acceleration[i] - mean_x);
    xy += (acceleration[i] - mean_x) * (shown[i] - mean_y);
  }
  if (!(xx > 0.0)) return {};
  return {.slope = xy / xx, .intercept = mean_y - xy / xx * mean_x};
}

}  // namespace veridyn::vehicle
