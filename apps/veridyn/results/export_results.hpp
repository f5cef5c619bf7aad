#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "apps/veridyn/results/analysis_results.hpp"
#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "veridyn/estimation/result/estimate.hpp"

namespace veridyn::app {

/// The estimate that `--estimate-file` names; none without it.
[[nodiscard]] std::optional<estimation::Estimate> given_estimate(const StudyRun& run);

/// Whether an estimate says for which purposes its numbers may be used.
[[nodiscard]] bool is_graded(const std::optional<estimation::Estimate>& estimate);

/// Publishes an export whose files are written: its record with what was read beyond the study, a line a file, `more`
/// where there is something, and the grades.
void publish_export(const StudyRun& run, OutputFolder& folder, std::vector<std::filesystem::path> inputs,
                    const std::optional<estimation::Estimate>& estimate, const MoreResults& more = {});

}  // namespace veridyn::app
