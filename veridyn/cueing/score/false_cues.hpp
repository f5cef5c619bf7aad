#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "veridyn/cueing/score/felt_motion.hpp"

namespace veridyn::cueing {

/// A stretch in which the rider feels what the driver did not, or does not feel what the driver did.
struct FalseCue {
  enum class Kind {
    kWrongSign,  ///< the other way, above threshold
    kTooStrong,  ///< the same way, more than twice as strong
    kMissing,    ///< not noticed, where the driver felt more than twice the threshold
  };
  Cue cue = Cue::kSurge;
  Kind kind = Kind::kWrongSign;
  double begin = 0.0, end = 0.0;  ///< [s]
  double size = 0.0;              ///< largest deviation of what is felt [m/s^2 or rad/s]
};
/// "wrong sign", "too strong", "missing".
[[nodiscard]] std::string_view name_of(FalseCue::Kind kind);

/// The false cues among two signals on an even grid, by time. Shorter ones than 0.1 s are none; of the same kind with
/// less than 0.1 s between them they are one.
[[nodiscard]] std::vector<FalseCue> false_cues(Cue cue, std::span<const double> vehicle,
                                               std::span<const double> platform, double threshold, double begin,
                                               double step);

}  // namespace veridyn::cueing
