#pragma once

#include <vector>

#include "veridyn/muscle/study/muscle_run.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// The model at its first and at its last pose, two plots to stand side by side: stick figure, joint centres and muscle
/// paths, with the sticks of some poses on the way behind them. In the plane of two ground axes in which most of the
/// motion is; drawn to scale. Muscles by name up to `most_names`, all of one colour beyond.
[[nodiscard]] std::vector<XYPlot> skeleton_figure(const muscle::MuscleStudy& study, const muscle::MuscleResult& result,
                                                  std::size_t most_names = 12);

}  // namespace veridyn::report
