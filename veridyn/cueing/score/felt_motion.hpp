#pragma once

#include <string_view>
#include <vector>

#include "veridyn/core/enum_array.hpp"
#include "veridyn/cueing/chain/cueing_chain.hpp"
#include "veridyn/cueing/perception/perception.hpp"

namespace veridyn::cueing {

/// What a driver can feel: forces forward, right, down, and turns.
enum class Cue { kSurge, kSway, kHeave, kRoll, kPitch, kYaw };
/// How many cues there are.
inline constexpr std::size_t kCues = 6;
/// All of them, in order.
inline constexpr auto kAllCues = enumerators<Cue, kCues>();
/// A value for each cue.
template <class T>
using PerCue = EnumArray<Cue, T, kCues>;

/// "surge", "sway", ...
[[nodiscard]] std::string_view name_of(Cue cue);
/// "m/s^2" or "rad/s".
[[nodiscard]] std::string_view unit_of(Cue cue);

/// One cue in the vehicle and on the platform, a value a sample.
struct CuePair {
  std::vector<double> vehicle, platform;
};

/// A drive as the driver would have felt it in the vehicle, and as the rider felt it on the platform, both through the
/// same organs of balance. Of heave's force that of rest is taken off.
struct FeltMotion {
  std::vector<double> time;
  PerCue<CuePair> felt;      ///< after canals and otoliths
  PerCue<CuePair> physical;  ///< specific force and angular rate themselves
  PerCue<double> threshold;  ///< below it nothing is noticed [m/s^2, rad/s]
};

/// @param model with units of force and rate ("1"), see `VestibularModel` @throws InputError for one without
[[nodiscard]] FeltMotion felt_motion(const CueingRun& run, const VestibularModel& model,
                                     const MotionThresholds& thresholds);

}  // namespace veridyn::cueing
