#pragma once

#include <string>
#include <vector>

#include "veridyn/live/rig/live_replay.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// The report of `veridyn cue --live` and `--replay`: whether orders kept their time and the platform its limits, what
/// became of every packet, what the rig did when and why, and the score of `cueing_report`.
/// @param score of the run; without algorithms: it was too short for one
/// @param notes what else its reader should know: what the machine refused, messages to the operator
[[nodiscard]] Document live_report(const live::LiveReplay& run, const cueing::CueingResult& score,
                                   const std::vector<std::string>& notes, const std::string& program);

}  // namespace veridyn::report
