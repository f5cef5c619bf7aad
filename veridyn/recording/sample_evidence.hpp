#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"

namespace veridyn::recording {

/// Whether one value for long is a fault.
enum class Rest {
  kFault,     ///< of a sensor that is moved
  kLongOnly,  ///< of a control only where it is very long
  kControl,   ///< of a control, which says that nothing of its effect is seen meanwhile: stated, where it is long
  kNone       ///< of a control whose rest is judged by what the vehicle does
};

/// A channel whose samples are looked at.
struct SampledChannel {
  std::string channel;
  std::string about;  ///< what rows call it: "gyro"
  Rest rest = Rest::kFault;
  [[nodiscard]] bool may_rest() const { return rest != Rest::kFault; }
};

/// What is wrong with the samples themselves inside `spans`, one row for each that is: a value that stands still while
/// the sensor is moved, one value held over several stamps (one measurement, not many), a reading that sits at the end
/// of its range, steps so coarse that little of the signal is left, single samples far from both neighbours. One row
/// "samples" where nothing is. Channels are looked at side by side on `threads` threads, 0: as many as the machine has.
[[nodiscard]] std::vector<estimation::Evidence> sample_evidence(const Recording& recording,
                                                                std::span<const SampledChannel> channels,
                                                                std::span<const TimeSpan> spans, int threads = 1);

}  // namespace veridyn::recording
