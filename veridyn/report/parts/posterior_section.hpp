#pragma once

#include <span>

#include "veridyn/estimation/result/parameter.hpp"
#include "veridyn/estimation/uncertainty/posterior_sampling.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// Draws of a posterior: a table of the intervals alongside those of the error bars, a small histogram for each
/// parameter with the normal curve of its error bar, and the two parameters that go together most. Empty without draws.
/// `parameters`: the estimate, in the model's order.
[[nodiscard]] Section posterior_section(const estimation::PosteriorSample& posterior,
                                        std::span<const estimation::Parameter> parameters);

}  // namespace veridyn::report
