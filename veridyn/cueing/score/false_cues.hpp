#pragma once

#include <span>

#include "veridyn/cueing/score/cueing_score.hpp"

namespace veridyn::cueing {

/// The false cues among two signals on an even grid, by time. Shorter ones than 0.1 s are none; of the same kind with
/// less than 0.1 s between them they are one.
[[nodiscard]] std::vector<FalseCue> false_cues(Cue cue, std::span<const double> vehicle,
                                               std::span<const double> platform, double threshold, double begin,
                                               double step);

}  // namespace veridyn::cueing
