#pragma once

#include <array>
#include <string>
#include <vector>

#include "veridyn/cueing/score/felt_motion.hpp"
#include "veridyn/cueing/washout/washout_design.hpp"

namespace veridyn::cueing {

/// What one knob does: the same short drive with the knob at half, as set, and at twice.
struct KnobEffect {
  Knob knob;  ///< its values as set; `values` points to nothing that lives
  std::array<double, 3> factors = {0.5, 1.0, 2.0};
  Cue cue = Cue::kSurge;                        ///< which it changes most
  double difference = 0.0;                      ///< RMS between half and twice, over the cue's threshold
  std::vector<double> time;                     ///< [s]
  std::vector<double> vehicle;                  ///< felt in the vehicle [m/s^2, rad/s]
  std::array<std::vector<double>, 3> platform;  ///< felt on the platform, by factor
};

/// A drive of 30 s on a level road: braking at 2 s, a bend to the left at 11 s, a bump at 22 s; flu.
[[nodiscard]] std::vector<recording::MotionSample> knob_drive();

/// The effects of all knobs of an algorithm. Values that a knob may not take, and designs that the platform refuses,
/// are left as set. @throws InputError as `felt_motion`.
[[nodiscard]] std::vector<KnobEffect> knob_effects(const WashoutDesign& design, const Platform& platform,
                                                   const VestibularModel& model, const MotionThresholds& thresholds);

}  // namespace veridyn::cueing
