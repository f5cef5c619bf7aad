#pragma once

#include <string>

#include "veridyn/muscle/study/identify_muscles.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// A person's muscles estimated from tasks, or an estimate validated on other tasks: grades, parameters with intervals
/// and a word each, what only combinations are known of, tasks before and after with pictures, checks, costs.
[[nodiscard]] Document muscle_task_report(const muscle::TaskStudy& study, const muscle::MuscleAnalysis& analysis,
                                          const std::string& program, bool validation_only = false);

}  // namespace veridyn::report
