#pragma once

#include <span>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/recording/sample_evidence.hpp"

namespace veridyn::recording {

/// Samples that have the stamp of the sample before inside `spans`, a row for each clock whose channels have more than
/// a few: two values at one moment, of which one is of another. Channels that share their stamps share a row.
[[nodiscard]] std::vector<estimation::Evidence> stamp_evidence(const Recording& recording,
                                                               std::span<const SampledChannel> channels,
                                                               std::span<const TimeSpan> spans);

}  // namespace veridyn::recording
