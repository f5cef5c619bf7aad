#pragma once

#include <span>
#include <string>

#include "veridyn/estimation/result/parameter.hpp"
#include "veridyn/estimation/uncertainty/profile_likelihood.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// Profile likelihoods: a table of the intervals alongside those of the error bars, a small plot for each parameter
/// (the profile, the parabola of the error bar, the threshold of 95 %, open ends marked), and the pair of parameters
/// that make up for each other most. Empty without profiles. `parameters`: the estimate, in the model's order; `note`:
/// a sentence more on what the intervals hold.
[[nodiscard]] Section profile_section(const estimation::ProfileResult& result,
                                      std::span<const estimation::Parameter> parameters, const std::string& note = {});

}  // namespace veridyn::report
