#pragma once

#include <string>

#include "veridyn/report/document/document.hpp"
#include "veridyn/vehicle/scale_study.hpp"

namespace veridyn::report {

/// The report of `veridyn scale`: the scaled vehicle, the table of groups with mismatches and what suffers, gravity
/// separately, and the drives of prototype, twin and given model laid over each other.
[[nodiscard]] Document similarity_report(const vehicle::ScaleStudy& study, const vehicle::ScaleAnalysis& analysis,
                                         const std::string& program);

/// Drives of prototype, twin and given model compared number by number; also part of other reports.
[[nodiscard]] Section difference_section(const vehicle::ScaleAnalysis& analysis);
/// The dimensionless groups and by how much they differ; also part of other reports.
[[nodiscard]] Section group_section(const vehicle::ScaleAnalysis& analysis);
/// The drives laid over each other, in similar units; also part of other reports.
[[nodiscard]] std::vector<Section> overlay_sections(const vehicle::ScaleStudy& study,
                                                    const vehicle::ScaleAnalysis& analysis);

}  // namespace veridyn::report
