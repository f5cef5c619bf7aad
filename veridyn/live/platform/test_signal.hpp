#pragma once

#include <string_view>

#include "veridyn/cueing/platform/platform_limits.hpp"

namespace veridyn::live {

/// Commands to a platform by hand, one axis at a time.
enum class TestSignal {
  kHome,   ///< neutral
  kZero,   ///< the same: the zero of every command
  kPose,   ///< a position
  kForce,  ///< the tilt that gives the rider a lasting force
  kMin,    ///< the lowest position
  kMax,    ///< the highest
  kWave,   ///< a sine about neutral
  kSteps,  ///< up, neutral, down, neutral
  kSweep,  ///< a sine whose frequency grows, which finds how the platform follows
};

/// How many there are.
inline constexpr std::size_t kTestSignals = 9;
/// "home", "zero", "pose", "force", "min", "max", "wave", "steps", "sweep".
[[nodiscard]] std::string_view name_of(TestSignal signal);

/// How a signal is played.
struct TestSignalOptions {
  TestSignal signal = TestSignal::kSweep;
  double position = 0.0;         ///< of a pose or a tilt [m or rad]
  double size = 0.5;             ///< of what the limits allow, 0 to 1
  double frequency = 0.5;        ///< of the wave; steps change as often as it turns [Hz]
  double low = 0.1, high = 6.0;  ///< of the sweep [Hz]
  double duration = 60.0;        ///< of the sweep [s]
};

/// Commanded position at a time [m or rad]. Sines, of wave and sweep, are as large as range, rate and acceleration
/// of the axis allow at their frequency, times `size`, so that a guard has nothing to hold back. They begin and end at
/// rest within a second.
[[nodiscard]] double wanted_position(const TestSignalOptions& options, const cueing::AxisLimits& limits, double time);

/// Angle at which a platform at rest gives its rider this specific force [rad]: pitch of a force forward, roll of one
/// to the right, positive as `cueing::PlatformCommand` has them. NaN of another axis and of more than gravity.
[[nodiscard]] double tilt_of(cueing::PlatformAxis axis, double force);

/// Frequency of the sweep at a time [Hz]: it grows by the same factor every second.
[[nodiscard]] double sweep_frequency(const TestSignalOptions& options, double time);

}  // namespace veridyn::live
