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

/// How recorded channels become signals. Study table `[signals]`; every key is optional.
struct DriveSignalOptions {
  double rate_Hz = 0.0;  ///< `rate`: of the common grid; 0 takes that of the yaw rate, at most 100 Hz
  /// `pass_band`: of the equation-error regressions, which differentiate [Hz]; 0 takes 2 Hz, or a tenth of the rate
  /// where that is less. Output error works on the unfiltered signals.
  double pass_Hz = 0.0;
  double steering_ratio = 0.0;  ///< `steering_ratio`: hand wheel over road wheels; needed with `steering_wheel`
  double rolling_radius = 0.0;  ///< `rolling_radius` [m]: speed from the rear wheels where there is no `speed`
  /// `accel_position = [x, y, z]`: of the accelerometer from the centre of gravity, forward, left, up [m].
  std::array<double, 3> accel_position{};
  /// `velocity_position`: how far ahead of the centre of gravity `lateral_velocity`, `sideslip` and `course` are
  /// measured [m].
  double velocity_position = 0.0;
  /// `roll_gradient` [rad/(m/s^2)]: how far the body leans outward per lateral acceleration. A sensor fixed to the
  /// body then shows (1 + g roll_gradient) a_y; 5 deg per g (0.0089) make 8.7 % of it, which would all be read as
  /// softer or stiffer tyres. Taken off; 0: not known. Ignored where `roll` is recorded, of which g sin(roll) is taken
  /// off.
  double roll_gradient = 0.0;
  /// `[signals.noise]`: standard deviation of a channel's white noise per sample by standard name; what is not given is
  /// measured from the channel's content above 0.2 of its rate.
  recording::GivenNoise noise = {};
  double gravity = kGravity;  ///< [m/s^2]

  /// @throws InputError naming file, line and key.
  [[nodiscard]] static DriveSignalOptions read(const StudyTable& table);
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
