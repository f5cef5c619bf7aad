#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/enum_array.hpp"
#include "veridyn/core/recording.hpp"
#include "veridyn/core/units.hpp"
#include "veridyn/numerics/resample.hpp"

namespace veridyn::recording {

/// Signals of a drive that say something of each other, axes forward, left, up.
enum class InertialChannel {
  kAccelX,
  kAccelY,
  kAccelZ,
  kGyroX,
  kGyroY,
  kGyroZ,
  kRoll,
  kPitch,
  kYaw,
  kSpeed,
  kSteer,
  kPosX,
  kPosY
};
/// How many there are.
inline constexpr std::size_t kInertialChannels = 13;
/// A value for each of them.
template <class T>
using PerInertialChannel = EnumArray<InertialChannel, T, kInertialChannels>;
/// Their standard names.
inline constexpr PerInertialChannel<std::string_view> kInertialChannelNames{
    "accel_x", "accel_y", "accel_z", "gyro_x", "gyro_y", "gyro_z", "roll",
    "pitch",   "yaw",     "speed",   "steer",  "pos_x",  "pos_y"};

/// What a drive calls them: kGyroZ may be "yaw_rate", kSteer "steering_wheel".
using ChannelNames = PerInertialChannel<std::string>;

/// A drive on an even grid; a signal that is missing is empty, a value that is missing NaN. Angles are not wrapped.
struct DriveMotion {
  numerics::UniformGrid grid{.step = 0.02};
  PerInertialChannel<std::vector<double>> signals = {};
  /// In which the numbers were taken to be recorded; of a signal that is not named, SI.
  PerInertialChannel<Unit> recorded_in = si_units();
  ChannelNames names = standard_names();
  bool hand_wheel = false;      ///< kSteer is the hand wheel's angle
  bool course_for_yaw = false;  ///< kYaw is the direction of motion, which has the sideslip

  [[nodiscard]] bool has(InertialChannel channel) const { return !signals[channel].empty(); }
  /// Takes the unit in which a channel was recorded; SI where that is not known or of another dimension.
  void take_unit(InertialChannel to, const Channel& channel);
  [[nodiscard]] static PerInertialChannel<Unit> si_units();
  [[nodiscard]] static ChannelNames standard_names();
};

/// Channels of a drive (frame flu) on an even grid of 50 Hz.
[[nodiscard]] DriveMotion drive_motion(const Recording& recording);

}  // namespace veridyn::recording
