#pragma once

#include <string>
#include <vector>

#include "apps/veridyn/run/output_folder.hpp"
#include "apps/veridyn/run/summary.hpp"
#include "veridyn/estimation/uncertainty/posterior_sampling.hpp"

namespace veridyn::app {

/// posterior.csv (every draw that was kept, with the logarithm of its density) and posterior_intervals.csv; nothing
/// without draws.
void write_posterior(OutputFolder& folder, const estimation::PosteriorSample& posterior);
/// An interval a line, and how long the walkers went.
[[nodiscard]] std::vector<std::string> posterior_lines(const estimation::PosteriorSample& posterior);
[[nodiscard]] Summary posterior_summary(const estimation::PosteriorSample& posterior);

}  // namespace veridyn::app
