#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/core/enum_array.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/recording/channel_map.hpp"
#include "veridyn/vehicle/identification/signals/drive_signals.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"

namespace veridyn::vehicle {

/// A sensor of a drive that may be wrong.
enum class DriveSuspect : std::size_t { kSteer, kSpeed, kYawRate, kAccelY, kAccelX };
/// How many there are.
inline constexpr std::size_t kDriveSuspects = 5;
/// A value for each of them.
template <class T>
using PerDriveSuspect = EnumArray<DriveSuspect, T, kDriveSuspects>;
/// Their names in rows, in the order of the enum.
inline constexpr PerDriveSuspect<std::string_view> kDriveSuspectNames{"steer", "speed", "yaw_rate", "accel_y",
                                                                      "accel_x"};

/// What one sensor reads over what others imply; 1 where all are right.
struct DriveRelation {
  DriveSuspect sensor = DriveSuspect::kYawRate;  ///< the sensor that is compared
  estimation::Check check = {};
  std::string against = {};      ///< "the rate of the heading"
  double low = 0.0, high = 0.0;  ///< range of the ratio, three standard errors included
  double correlation = 1.0;
  bool strong = false;    ///< the motion is large enough to compare
  bool verified = false;  ///< the range is narrow enough to verify a scale
  /// To which power an error of each sensor's scale is in the ratio: 1, -1 or 0.
  PerDriveSuspect<int> power{};
  estimation::Tolerance tolerance = {};

  /// Strong signals that are not the same motion.
  [[nodiscard]] bool unrelated() const;
  [[nodiscard]] double middle() const { return 0.5 * (low + high); }
  /// Passed, with care, failed: by range and correlation; passed where the motion is not strong.
  [[nodiscard]] estimation::Outcome outcome() const;
};

/// The relations that the channels of a drive allow, inside `spans` where the vehicle drives:
///
/// - yaw rate against the derivative of heading or course (of the channel `yaw`, `course`, or of the positions);
/// - speed against that of the positions;
/// - lateral acceleration against r u, with v' as a function of r', u^2 r' and r'' (the sideslip of a bicycle in slow
///   manoeuvres) and a bias;
/// - longitudinal acceleration against u', with r^2 (for r v) and a bias;
/// - steering against L r/u, with u r (understeer), r' and a bias: what is left is the scale of steering over
/// wheelbase.
///   Where the speed does not vary enough to separate understeer, an understeer gradient from -0.003 to 0.02
///   rad/(m/s^2) bounds it.
///
/// Gains are bracketed by regressions both ways (recording::signal_gain). What the recording lacks is left out.
[[nodiscard]] std::vector<DriveRelation> drive_relations(const recording::MappedRecording& mapped,
                                                         const DriveSignals& signals, std::span<const TimeSpan> spans,
                                                         double wheelbase);

/// Single sensors whose wrong scale or sign would explain every relation that is off, with the factor by which they
/// read too much; empty where all is well or none explains all. Sorted by the enum.
struct DriveCulprit {
  DriveSuspect sensor = DriveSuspect::kSteer;
  double factor = 1.0;  ///< NaN: no factor explains it, the signal is another one
  double doubt = 0.0;   ///< of the factor, as a share of it
};
/// The sensors that explain what is off.
[[nodiscard]] std::vector<DriveCulprit> culprits(std::span<const DriveRelation> relations);

}  // namespace veridyn::vehicle
