#pragma once

#include <span>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/estimation/open_loop/open_loop.hpp"

namespace veridyn::estimation {

/// What is left of `stretches` without `seen`, in order.
[[nodiscard]] std::vector<TimeSpan> unseen(std::span<const TimeSpan> stretches, std::span<const TimeSpan> seen);

/// Windows for an open-loop integration. One begins where one of `excited` does, and again where one ends inside of it;
/// it lasts for `times.duration_s`, or until the stretch of `free` around its beginning is over; one that begins in
/// none lasts until its excited span is. Too short for its first seconds and kLeastForecast_s: left out.
/// @param excited  in order
/// @param free  what may be integrated over: usable, and not seen by identification
[[nodiscard]] std::vector<TimeSpan> open_loop_windows(std::span<const TimeSpan> excited, std::span<const TimeSpan> free,
                                                      const OpenLoopTimes& times);

}  // namespace veridyn::estimation
