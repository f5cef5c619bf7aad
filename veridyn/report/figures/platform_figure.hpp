#pragma once

#include "veridyn/cueing/cueing_study.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// The platform in space, with its actuators and a seated rider, where each algorithm brings it over time: surge
/// forward, sway right, heave up, roll right side down, pitch nose up, yaw nose right. At most `most_samples` numbers
/// altogether, on an even grid (said in the caption); as sampled where these suffice.
[[nodiscard]] Scene platform_figure(const cueing::Platform& platform, const cueing::CueingResult& result,
                                    std::size_t most_samples = 20000);

}  // namespace veridyn::report
