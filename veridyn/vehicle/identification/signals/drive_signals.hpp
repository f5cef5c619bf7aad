#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/enum_array.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/recording/channel_map.hpp"
#include "veridyn/recording/grid_signals.hpp"

namespace veridyn::vehicle {

/// What identification of a vehicle looks at. Axes ISO 8855, SI.
enum class DriveSignal : std::size_t {
  kSteer,            ///< delta at the road wheels, left positive [rad]
  kSpeed,            ///< u, forward speed of the centre of gravity [m/s]
  kYawRate,          ///< r [rad/s]
  kAccelY,           ///< at the sensor's place, gravity's share taken off as far as it is known [m/s^2]
  kAccelX,           ///< [m/s^2]
  kLateralVelocity,  ///< v of the centre of gravity [m/s]
  kX,                ///< position on the ground [m]
  kY,
  kYaw,      ///< heading [rad], unwrapped
  kRoll,     ///< of the body, left side up [rad]
  kRollRate  ///< [rad/s]
};
/// How many signals there are.
inline constexpr std::size_t kDriveSignals = 11;
/// Their standard names, in the order of the enum.
inline constexpr EnumArray<DriveSignal, std::string_view, kDriveSignals> kDriveSignalNames{
    "steer", "speed", "yaw_rate", "accel_y", "accel_x",  "lateral_velocity",
    "pos_x", "pos_y", "yaw",      "roll",    "roll_rate"};
/// Their units, in the same order.
inline constexpr EnumArray<DriveSignal, std::string_view, kDriveSignals> kDriveSignalUnits{
    "rad", "m/s", "rad/s", "m/s^2", "m/s^2", "m/s", "m", "m", "rad", "rad", "rad/s"};

/// How recorded channels become signals. Study table `[signals]`.
struct DriveSignalOptions {
  double rate_Hz = 0.0;                    ///< of the common grid; 0: by the yaw rate
  double pass_Hz = 0.0;                    ///< of regressions, which differentiate; 0: by the rate
  double steering_ratio = 0.0;             ///< hand wheel over road wheels; 0: not known
  double rolling_radius = 0.0;             ///< [m]; 0: not known
  std::array<double, 3> accel_position{};  ///< from the centre of gravity: forward, left, up [m]
  double velocity_position = 0.0;          ///< ahead of the centre of gravity [m]
  double roll_gradient = 0.0;              ///< [rad/(m/s^2)]; 0: not known
  recording::GivenNoise noise = {};        ///< what is not given is measured
  double gravity = kGravity;               ///< [m/s^2]

  [[nodiscard]] static const KeyTable<DriveSignalOptions>& keys();
};

using recording::GridSignal;

/// All signals of a drive on one uniform grid, unfiltered, in ISO 8855.
struct DriveSignals : recording::GridSignals<DriveSignal, kDriveSignals> {
  std::string source;
  std::array<double, 3> accel_position{};
  bool gravity_removed = false;  ///< from roll or roll gradient
  /// By which accel_y was divided through 1 + g times it; 0: not by a gradient [rad/(m/s^2)].
  double roll_gradient = 0.0;
  /// Whether the lateral velocity is made of course and heading (`course_lateral_velocity`), whose offset and delay the
  /// drive model then estimates.
  bool lateral_by_course = false;
};

/// Resamples the mapped channels to one grid and derives what is missing: steering from the hand wheel, speed from the
/// rear wheels (or, without them, the front wheels), yaw rate from `gyro_z`, lateral velocity from `sideslip`, or from
/// speed, course and heading.
/// @throws InputError when yaw rate, speed or steering is missing (the latter only with `needs_steer`), a signal holds
/// no numeric values, or the yaw rate is slower than 5 Hz.
[[nodiscard]] DriveSignals prepare_drive_signals(const recording::MappedRecording& mapped,
                                                 const DriveSignalOptions& options, bool needs_steer = true);

}  // namespace veridyn::vehicle
