#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"

namespace veridyn::recording {

/// A channel whose samples are looked at.
struct SampledChannel {
  std::string channel;
  std::string about;      ///< what rows call it: "gyro"
  bool may_rest = false;  ///< a control, which may stand still for long
};

/// What is wrong with the samples themselves inside `spans`, one row for each that is: a value that stands still while
/// the sensor is moved, one value held over several stamps (one measurement, not many), a reading that sits at the end
/// of its range, steps so coarse that little of the signal is left, single samples far from both neighbours. One row
/// "samples" where nothing is.
[[nodiscard]] std::vector<estimation::Evidence> sample_evidence(const Recording& recording,
                                                                std::span<const SampledChannel> channels,
                                                                std::span<const TimeSpan> spans);

}  // namespace veridyn::recording
