#pragma once

#include <string>
#include <vector>

#include "apps/veridyn/run/output_folder.hpp"
#include "apps/veridyn/run/summary.hpp"
#include "veridyn/core/recording.hpp"
#include "veridyn/estimation/open_loop/open_loop.hpp"

namespace veridyn::app {

/// What was integrated open loop: `open_loop_scores.csv`, and the states of each group, whose windows differ:
/// `open_loop_longitudinal.csv`, or `open_loop.csv` of the only one. Nothing where nothing was.
void write_open_loop(OutputFolder& folder, const estimation::OpenLoop& open_loop, Frame frame);
/// What was done, and a line a state.
[[nodiscard]] std::vector<std::string> open_loop_lines(const estimation::OpenLoop& open_loop);
/// The scores by state.
[[nodiscard]] Summary open_loop_summary(const estimation::OpenLoop& open_loop);

}  // namespace veridyn::app
