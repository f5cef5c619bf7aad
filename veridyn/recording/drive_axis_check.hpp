#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/core/enum_array.hpp"
#include "veridyn/recording/channel_map.hpp"

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

/// A drive on an even grid; a signal that is missing is empty, a value that is missing NaN. Angles are not wrapped.
struct DriveMotion {
  double step = 0.02;  ///< [s]
  PerInertialChannel<std::vector<double>> signals;
  bool hand_wheel = false;  ///< kSteer is the hand wheel's angle
};

/// One signal against what others say that it should be, low-passed by 0.8 s.
struct AxisRelation {
  std::string text;                           ///< "accel_x against the change of speed"
  InertialChannel channel{};                  ///< the one signal
  double slope = 0.0, low = 0.0, high = 0.0;  ///< 1 where all is well; 95 % by leaving out blocks of 5 s
  double correlation = 0.0;
  double seconds = 0.0;  ///< of drive in which there is something to compare
  bool judged = false;   ///< enough to compare, and it correlates
  bool fits = false;     ///< judged, and the slope is that of a right channel
};

/// A fault that explains the relations, and what mends it.
struct DriveFault {
  std::string text;                ///< "accel_y has the wrong sign"
  double correlation = 0.0;        ///< the weakest one among the relations that it explains
  std::vector<std::string> lines;  ///< of `[data.map]`, or of `[data]` for the frame
};

/// What the check says.
struct DriveAxisCheck {
  std::vector<AxisRelation> relations;
  /// The fewest faults that explain all relations. Empty: none is needed.
  std::vector<DriveFault> faults;
  /// Where several sets of as few faults explain them as well: those of the others.
  std::vector<std::vector<DriveFault>> or_else;
  std::vector<std::string> notes;  ///< what could not be compared or explained
};

/// Channels of a drive (frame flu) on an even grid of 50 Hz.
[[nodiscard]] DriveMotion drive_motion(const Recording& recording);

/// Looks for axes, signs and units that are wrong:
///
///     accel_x = d(speed)/dt       accel_y = speed gyro_z       gyro_z = d(yaw)/dt (gyro_x, roll; gyro_y, pitch)
///     speed = |d(pos)/dt|         gyro_z along speed steer     accel_z = g at rest, or none
///
/// Each relation gives a factor; signs, exchanged axes, g for m/s^2, deg for rad, km/h or mph for m/s, the frame frd
/// and gravity counted twice each foretell factors, and the fewest of them that foretell all are named. Accuracies of a
/// few percent are not judged: only what is wrong by a third and more.
/// @param origins of the channels, for the lines that mend them
[[nodiscard]] DriveAxisCheck check_drive_axes(const DriveMotion& motion, std::span<const ChannelOrigin> origins = {});

}  // namespace veridyn::recording
