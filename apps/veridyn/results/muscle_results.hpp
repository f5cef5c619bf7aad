#pragma once

#include <filesystem>
#include <vector>

#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "veridyn/muscle/study/identify_muscles.hpp"

namespace veridyn::app {

/// Writes, publishes and prints the identification or validation of a person's muscles.
void publish_muscles(const StudyRun& run, OutputFolder& folder, const muscle::TaskStudy& study,
                     const muscle::MuscleAnalysis& analysis);

}  // namespace veridyn::app
