#include "veridyn/vehicle/identification/evidence/noise_free.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace veridyn::vehicle {
namespace {

/// Of a signal's deviation, below which noise is none of a sensor but the rounding of a simulator. A fibre gyro has
/// 0.01 deg/s where a car yaws by 3 to 10 deg/s (rms): 1 to 3 thousandths; those of production cars have ten times it.
constexpr double kLeastNoise = 1e-3;

double deviation_of(const DriveSignals& signals, const std::vector<double>& value, std::span<const TimeSpan> spans) {
  double sum = 0.0, squares = 0.0, count = 0.0;
  for (const TimeSpan& span : spans) {
    const auto [first, last] = signals.indices(span);
    for (std::size_t k = first; k < last; ++k) {
      if (!std::isfinite(value[k])) continue;
      sum += value[k];
      squares += value[k] * value[k];
      count += 1.0;
    }
  }
  return count > 0.0 ? std::sqrt(std::max(0.0, squares / count - sum * sum / (count * count))) : 0.0;
}

}  // namespace

bool is_noise_free(const DriveSignals& signals, std::span<const TimeSpan> spans) {
  return std::ranges::all_of(
      std::array{DriveSignal::kSteer, DriveSignal::kYawRate, DriveSignal::kAccelY, DriveSignal::kLateralVelocity},
      [&](DriveSignal signal) {
        const recording::GridSignal& s = signals[signal];
        const bool optional = signal == DriveSignal::kAccelY || signal == DriveSignal::kLateralVelocity;
        if (!s.available()) return optional;
        return s.sigma < kLeastNoise * deviation_of(signals, s.value, spans);
      });
}

}  // namespace veridyn::vehicle
