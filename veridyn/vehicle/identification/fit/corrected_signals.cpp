#include "veridyn/vehicle/identification/fit/corrected_signals.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

#include "veridyn/vehicle/identification/fit/sampled_input.hpp"
#include "veridyn/vehicle/identification/options/drive_unknown.hpp"

namespace veridyn::vehicle {
namespace {

/// As it was `later` seconds after each moment of the grid; beside gaps, and at both ends, as near to that as it was
/// recorded.
void shift(std::vector<double>& value, double later, double step) {
  if (value.empty() || later == 0.0) return;
  const std::vector<double> recorded = value;
  const double samples = later / step;
  for (std::size_t k = 0; k < value.size(); ++k) {
    if (!std::isfinite(recorded[k])) continue;
    double moved = samples;
    for (;;) {
      const double there = between(recorded, static_cast<double>(k) + moved);
      if (std::isfinite(there)) {
        value[k] = there;
        break;
      }
      if (std::abs(moved) < 1.0) break;  // it stays
      moved -= std::copysign(1.0, moved);
    }
  }
}

}  // namespace

DriveSignals corrected_signals(DriveSignals signals, const Eigen::VectorXd& theta) {
  const auto found = [&](DriveUnknown u) { return theta(static_cast<Eigen::Index>(u)); };
  const double step = signals.grid.step;
  // The wheels answer later than the recorded steering: they were where it was before.
  shift(signals[DriveSignal::kSteer].value, -found(DriveUnknown::kSteerDelay), step);
  shift(signals[DriveSignal::kYawRate].value, found(DriveUnknown::kYawRateDelay), step);
  shift(signals[DriveSignal::kAccelY].value, found(DriveUnknown::kAccelYDelay), step);
  signals.accel_position[0] += found(DriveUnknown::kAccelPlace);
  signals.accel_position[2] += found(DriveUnknown::kAccelHeight);
  return signals;
}

}  // namespace veridyn::vehicle
