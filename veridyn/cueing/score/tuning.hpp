#pragma once

#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/cueing/score/felt_motion.hpp"
#include "veridyn/cueing/washout/washout_design.hpp"

namespace veridyn::cueing {

/// What the automatic tuning minimises, and how long it looks.
struct TuningOptions {
  /// Weight of each cue; of cues that the driver never feels none.
  PerCue<double> weights = {{1.0, 1.0, 0.3, 0.3, 0.3, 0.1}};
  /// Share of the vehicle's felt motion (RMS) that the platform is to have at least.
  double strength = 0.2;
  /// Weight of the share of time in which an axis is held back by a limit.
  double limited = 0.2;
  std::size_t evaluations = 150;
};

/// A knob before and after.
struct TunedKnob {
  std::string name, unit;
  std::vector<double> before, after;
};

/// What tuning found.
struct Tuning {
  std::unique_ptr<WashoutDesign> design;
  std::vector<TunedKnob> knobs;  ///< that changed
  double cost_before = 0.0, cost_after = 0.0;
  std::size_t evaluations = 0;
  bool interrupted = false;
};

/// Cost of a run: mean over the cues, weighted, of
///
///     1 - r + 1/2 max(0, 1 - s / strength, s - 1)
///
/// plus the weighted share of time at limits; r is the correlation of what is felt on the platform with what is felt in
/// the vehicle and s the ratio of their RMS. 1 - r^2 is the error that is left when the vehicle's motion is scaled
/// best: a rider does not notice a scale. (The error without a scale is least for a platform that hardly moves.) One
/// that stands still costs 1.5, one that does as the vehicle does 0.
[[nodiscard]] double tuning_cost(const CueingRun& run, const FeltMotion& felt, const TuningOptions& options);

/// Turns the knobs that have a range for it, by the pattern search on logarithms of their values, until the drive costs
/// least on the platform, its limits and actuators included. Knobs with a zero in their range are turned as they are.
/// The gains of
/// force and rate are halved up to four times first; then half of the evaluations that are left turn all numbers of a
/// knob together, the others each by itself.
[[nodiscard]] Tuning tuned(const WashoutDesign& design, const Platform& platform,
                           const std::vector<recording::MotionSample>& drive, const VestibularModel& model,
                           const MotionThresholds& thresholds, const TuningOptions& options, Progress& progress);

}  // namespace veridyn::cueing
