#pragma once

#include "veridyn/cueing/cueing_study.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// A value of a cue as reports show it: turns in degrees.
[[nodiscard]] double shown(cueing::Cue cue, double value);
/// The unit of that.
[[nodiscard]] const char* shown_unit(cueing::Cue cue);
/// A place on a platform's axis as reports show it: degrees, millimetres.
[[nodiscard]] double shown(cueing::PlatformAxis axis, double value);
/// The unit of that.
[[nodiscard]] const char* shown_unit(cueing::PlatformAxis axis);

/// Whether a cue is felt in the vehicle at all.
[[nodiscard]] bool is_moved(const cueing::CueingResult& result, cueing::Cue cue);

/// Correlations of all cues and algorithms at a glance.
[[nodiscard]] IntervalPlot correlation_figure(const cueing::CueingResult& result);
/// What is felt of each cue, in the vehicle and on the platform, over time.
[[nodiscard]] TimeSeries felt_histories(const cueing::CueingResult& result);
/// Where each axis of the platform is, over time.
[[nodiscard]] TimeSeries platform_histories(const cueing::CueingStudy& study, const cueing::CueingResult& result);
/// What each knob of an algorithm does.
[[nodiscard]] TimeSeries knob_figure(const cueing::AlgorithmResult& algorithm);

}  // namespace veridyn::report
