#pragma once

#include <string>

#include "veridyn/cueing/cueing_study.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// The report of `veridyn cue`: how close each algorithm comes to the felt motion of the drive, with intervals; where
/// they differ beyond them; false cues; what the platform used; time histories; gain and phase with their mask; tuned
/// knobs.
[[nodiscard]] Document cueing_report(const cueing::CueingStudy& study, const cueing::CueingResult& result,
                                     const std::string& program);

/// What the knobs of the study's algorithms do, where it asked for that.
[[nodiscard]] Document knob_report(const cueing::CueingStudy& study, const cueing::CueingResult& result,
                                   const std::string& program);

}  // namespace veridyn::report
