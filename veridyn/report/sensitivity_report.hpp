#pragma once

#include <span>
#include <string>

#include "veridyn/muscle/study/muscle_study_sensitivity.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// Which muscle moves which task: the tasks chosen and the runner-up, the heat map task x muscle, indices with their
/// intervals, what could not be simulated, what it cost.
[[nodiscard]] Document sensitivity_report(const muscle::SensitivityStudy& study,
                                          std::span<const muscle::PreparedTask> tasks,
                                          const muscle::MuscleSensitivity& result, const std::string& program);

}  // namespace veridyn::report
