#pragma once

#include <array>
#include <string>
#include <vector>

#include "veridyn/cueing/score/block_statistics.hpp"
#include "veridyn/cueing/score/false_cues.hpp"
#include "veridyn/cueing/score/felt_motion.hpp"

namespace veridyn::cueing {

/// Of one cue. All but the last two are of what is felt.
struct CueScore {
  Measured rmse;     ///< [m/s^2 or rad/s]
  Measured pearson;  ///< NaN where the vehicle or the platform does not move so
  Measured lag;      ///< of the platform behind the vehicle, where the correlation is largest [s]
  Measured at_lag;   ///< that correlation
  Measured above;    ///< share of time with a deviation above the threshold
  Measured physical_pearson, physical_lag;  ///< of force and rate themselves
};

/// What a platform's axis did.
struct AxisScore {
  double lowest = 0.0, highest = 0.0;  ///< [m or rad]
  double used = 0.0;                   ///< largest share of the range on its side, 0 to 1
  double limited = 0.0;                ///< share of time that the guard held it back
  double rate = 0.0;                   ///< largest share of the rate limit
  double rms_jerk = 0.0;               ///< [m/s^3 or rad/s^3]
};

/// The score of an algorithm on a drive.
struct CueingScore {
  std::string algorithm;
  PerCue<CueScore> cues = {};
  /// Of sway with roll and surge with pitch: e of `LeastError`, in thresholds.
  std::array<Measured, 2> pairs = {};
  std::vector<FalseCue> false_cues;      ///< by time
  PerPlatformAxis<AxisScore> axes = {};  ///< of axes that move
  double leg_speed = 0.0;                ///< largest share of the legs' rate; 0 of a platform without
  /// While the driver felt neither force nor turn: share of that time in which the platform turned above threshold.
  double felt_return = 0.0;
  double duration = 0.0;  ///< [s]
  std::vector<std::string> notes;

  /// For comparisons.
  PerCue<BlockStatistics> felt_blocks = {}, physical_blocks = {};
  std::uint64_t seed = 1;
};

/// Compares what the driver felt in the vehicle with what the rider felt on the platform: definitions with formulas in
/// docs/cueing.md. Cues are taken to an even grid of 50 Hz.
[[nodiscard]] CueingScore score(const CueingRun& run, const FeltMotion& felt, const Platform& platform,
                                std::uint64_t seed = 1);

/// The figures by which algorithms are compared.
enum class CueFigure { kRmse, kPearson, kLag, kPhysicalPearson, kPhysicalLag };

/// By how much a figure of `a` is above that of `b` on the same drive, with an interval over the same blocks of both:
/// they differ where it does not hold zero.
[[nodiscard]] Measured difference(const CueingScore& a, const CueingScore& b, Cue cue, CueFigure figure);

}  // namespace veridyn::cueing
