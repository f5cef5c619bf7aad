#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/summary.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/uncertainty/response_indices.hpp"
#include "veridyn/report/response_report.hpp"

namespace veridyn::app {

/// Indices of one result for the summary.
[[nodiscard]] Summary indices_summary(const estimation::ResultIndices& indices, const std::vector<std::string>& inputs);

/// A study of which input moves which result of a simulation, ready to run.
struct PreparedResponses {
  std::string stage;  ///< of the progress
  report::ResponseReportContext context = {};
  estimation::IndexOptions options = {};
  std::vector<std::filesystem::path> inputs = {};  ///< files read beyond the study
  std::function<estimation::ResponseIndices(numerics::BlockStore&, Progress&)> analyse = {};
};

/// `veridyn sensitivity` of a simulated motion: alone, from a checkpoint, or as one of several processes.
/// @param prepare  reads the study
/// @return the exit code
int run_responses(const StudyRun& run, const std::function<PreparedResponses(Progress&)>& prepare);

/// Refuses a study that names a recording, saying what is possible instead.
/// @param simulated  "[drive]"
void refuse_recording(const StudyTable& root, const char* simulated);

}  // namespace veridyn::app
