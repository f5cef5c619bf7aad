#include "veridyn/live/platform/test_signal.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/enum_array.hpp"

namespace veridyn::live {
namespace {

/// A sine that range, rate, acceleration and jerk allow: the least of theirs, with its corners rounded, so that a sweep
/// does not jerk where one takes over from another.
double most_at(const cueing::AxisLimits& limits, double frequency) {
  const double omega = 2.0 * kPi * frequency;
  const double range = std::min(limits.highest, -limits.lowest);
  double sum = 0.0;
  for (const double most :
       {range, limits.rate / omega, limits.acceleration / (omega * omega), limits.jerk / (omega * omega * omega)})
    sum += std::pow(most, -4.0);
  return std::pow(sum, -0.25);
}

/// From 0 to 1 within a second, without a jump in rate and acceleration.
double led_in(double time) {
  const double t = std::clamp(time, 0.0, 1.0);
  return t * t * t * (10.0 + t * (-15.0 + 6.0 * t));
}

}  // namespace

std::string_view name_of(TestSignal signal) {
  constexpr EnumArray<TestSignal, std::string_view, kTestSignals> kNamesOfSignals = {
      {"home", "zero", "pose", "force", "min", "max", "wave", "steps", "sweep"}};
  return kNamesOfSignals[signal];
}

double tilt_of(cueing::PlatformAxis axis, double force) {
  // The rider's forward axis points up where the nose does, the one to the right where the left side is down.
  if (axis == cueing::PlatformAxis::kPitch) return std::asin(force / kGravity);
  if (axis == cueing::PlatformAxis::kRoll) return -std::asin(force / kGravity);
  return kNaN;
}

double sweep_frequency(const TestSignalOptions& o, double time) {
  return o.low * std::pow(o.high / o.low, std::clamp(time / o.duration, 0.0, 1.0));
}

double wanted_position(const TestSignalOptions& o, const cueing::AxisLimits& limits, double time) {
  switch (o.signal) {
    case TestSignal::kHome:
    case TestSignal::kZero:
      return 0.0;
    case TestSignal::kPose:
    case TestSignal::kForce:
      return o.position;
    case TestSignal::kMin:
      return o.size * limits.lowest;
    case TestSignal::kMax:
      return o.size * limits.highest;
    case TestSignal::kWave:
      return o.size * most_at(limits, o.frequency) * led_in(time) * std::sin(2.0 * kPi * o.frequency * time);
    case TestSignal::kSteps: {
      const auto quarter = static_cast<long>(4.0 * o.frequency * time) % 4;
      return quarter == 0 ? o.size * limits.highest : quarter == 2 ? o.size * limits.lowest : 0.0;
    }
    case TestSignal::kSweep: {
      if (time >= o.duration) return 0.0;
      const double f = sweep_frequency(o, time), growth = std::log(o.high / o.low) / o.duration;
      const double phase = 2.0 * kPi * (f - o.low) / growth;
      return o.size * most_at(limits, f) * led_in(time) * led_in(o.duration - time) * std::sin(phase);
    }
  }
  return 0.0;
}

}  // namespace veridyn::live
