#include "veridyn/recording/stamp_evidence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <utility>

#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::recording {
namespace {

/// Channels with the same stamps.
struct Clock {
  std::span<const double> times;
  std::vector<std::string> about;
};

std::vector<Clock> clocks_of(const Recording& recording, std::span<const SampledChannel> channels) {
  std::vector<Clock> clocks;
  for (const SampledChannel& which : channels) {
    const Channel* channel = recording.find(which.channel);
    if (channel == nullptr) continue;
    const std::span<const double> times = channel->times();
    auto clock = std::ranges::find_if(clocks, [&](const Clock& c) { return std::ranges::equal(c.times, times); });
    if (clock == clocks.end()) clock = clocks.insert(clock, {times, {}});
    if (std::ranges::find(clock->about, which.about) == clock->about.end()) clock->about.push_back(which.about);
  }
  return clocks;
}

}  // namespace

std::vector<estimation::Evidence> stamp_evidence(const Recording& recording, std::span<const SampledChannel> channels,
                                                 std::span<const TimeSpan> spans) {
  std::vector<estimation::Evidence> rows;
  for (const Clock& clock : clocks_of(recording, channels)) {
    std::size_t samples = 0, repeated = 0;
    for (const TimeSpan& span : spans) {
      const auto first = std::ranges::lower_bound(clock.times, span.begin);
      const auto last = std::ranges::upper_bound(clock.times, span.end);
      samples += static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, last - first));
      for (auto next = first; next < last; ++next)
        if (next != first && *next == *(next - 1)) ++repeated;
    }
    if (samples == 0) continue;
    estimation::Evidence row =
        estimation::row_of(estimation::Check::kStamps, fmt::format("{}", fmt::join(clock.about, ", ")),
                           static_cast<double>(repeated) / static_cast<double>(samples));
    if (row.passed()) continue;
    row.cause = estimation::Cause::kStamps;
    rows.push_back(
        std::move(row).with("repeated", static_cast<double>(repeated)).with("samples", static_cast<double>(samples)));
  }
  return rows;
}

}  // namespace veridyn::recording
