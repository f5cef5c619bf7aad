#pragma once

#include "veridyn/cueing/cueing_study.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// Gain and phase of the whole chain over decades of frequency, a pair of plots a cue, the mask shaded behind them, and
/// what is outside in words. Phases go on beyond +-180 deg unless a mask, which is for -180 to 180 deg, limits them.
[[nodiscard]] Section response_section(const cueing::ResponseStudy& study, const cueing::CueingResult& result);

}  // namespace veridyn::report
