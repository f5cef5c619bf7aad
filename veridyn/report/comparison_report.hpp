#pragma once

#include <span>
#include <string>

#include "veridyn/estimation/result/estimate_comparison.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// The report of `veridyn compare`: agreement of every pair, intervals of each parameter side by side, their means.
[[nodiscard]] Document comparison_report(const estimation::EstimateComparison& comparison,
                                         std::span<const estimation::NamedEstimate> estimates,
                                         const std::string& program);

}  // namespace veridyn::report
