#pragma once

#include <span>
#include <string>
#include <vector>

#include "apps/veridyn/run/output_folder.hpp"
#include "apps/veridyn/run/summary.hpp"
#include "veridyn/estimation/result/parameter.hpp"
#include "veridyn/estimation/uncertainty/profile_likelihood.hpp"

namespace veridyn::app {

/// profiles.csv: every fit, with all parameters at it; profile_intervals.csv: the intervals, an end that is not closed
/// empty, and why. Nothing without profiles.
/// @param parameters  in the model's order
void write_profiles(OutputFolder& folder, const estimation::ProfileResult& profiles,
                    std::span<const estimation::Parameter> parameters);

/// The intervals for the summary, by parameter.
[[nodiscard]] Summary profiles_summary(const estimation::ProfileResult& profiles);

/// A line for each profile; why there is none.
[[nodiscard]] std::vector<std::string> profile_lines(const estimation::ProfileResult& profiles);

}  // namespace veridyn::app
