#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/estimation/open_loop/open_loop.hpp"
#include "veridyn/estimation/open_loop/open_loop_forecast.hpp"

namespace veridyn::estimation {

/// The scores of the outputs over the forecasts of the groups that they are judged in, group by group; those of which
/// nothing was measured are left out.
/// @param groups  in the order of the result
/// @param group_of  of an output by its name
[[nodiscard]] std::vector<OpenLoopState> open_loop_scores(std::span<const ModelOutput> outputs,
                                                          std::span<const OpenLoopForecast> forecasts,
                                                          std::span<const std::string> groups,
                                                          const std::function<std::string(std::string_view)>& group_of);

/// Adds where the windows lie, and how much of them was forecast.
void add_windows(std::span<const OpenLoopForecast> forecasts, OpenLoop& open_loop);

/// How many windows diverged.
[[nodiscard]] std::size_t diverged_windows(const OpenLoop& open_loop);

}  // namespace veridyn::estimation
