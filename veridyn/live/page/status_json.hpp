#pragma once

#include <string>

#include "veridyn/live/page/felt_now.hpp"
#include "veridyn/live/rig/live_loop.hpp"

namespace veridyn::live {

/// The status of a rig as its page reads it, in one line.
/// @param felt up to this status @param design with the knobs as they are now @param time from the run's start [s]
[[nodiscard]] std::string status_json(const RigStatus& status, const LiveStudy& study, const FeltNow& felt,
                                      cueing::WashoutDesign& design, double time, const std::string& message);

}  // namespace veridyn::live
