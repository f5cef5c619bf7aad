#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "veridyn/core/constants.hpp"
#include "veridyn/report/document/document.hpp"

/// Which part of time a figure shows.
namespace veridyn::report {

/// Leaves of lines, bands and spans what lies in the ranges, which are increasing and do not overlap; of spans what
/// lies between the beginning of the first and the end of the last. Nothing changes where there is no range.
void keep_within(TimeSeries& figure, std::span<const Window> ranges);

/// A figure for a report's first screen: of its windows the `most` longest alone, in the order of time, each from its
/// beginning for no more than `longest`, with a line in the caption where something is left out.
[[nodiscard]] TimeSeries in_longest_windows(TimeSeries figure, std::size_t most, double longest = kInfinity);

/// Every time series of a section that has no windows of its own, within a range and on an axis of this name.
void show_range(Section& section, const Window& range, const std::string& axis);

}  // namespace veridyn::report
