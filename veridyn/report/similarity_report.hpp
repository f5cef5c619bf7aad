#pragma once

#include <string>

#include "veridyn/report/document/document.hpp"
#include "veridyn/vehicle/scale_study.hpp"

namespace veridyn::report {

/// The report of `veridyn scale`: the scaled vehicle, the table of groups with mismatches and what suffers, gravity
/// apart, and the drives of prototype, twin and given model laid over each other.
[[nodiscard]] Document similarity_report(const vehicle::ScaleStudy& study, const vehicle::ScaleAnalysis& analysis,
                                         const std::string& program);

/// The sections of that report which other reports show too.
[[nodiscard]] Section difference_section(const vehicle::ScaleAnalysis& analysis);
[[nodiscard]] Section group_section(const vehicle::ScaleAnalysis& analysis);
[[nodiscard]] std::vector<Section> overlay_sections(const vehicle::ScaleStudy& study,
                                                    const vehicle::ScaleAnalysis& analysis);

}  // namespace veridyn::report
