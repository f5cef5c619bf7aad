#include "veridyn/core/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/rank.hpp"

namespace veridyn {
namespace {

/// The value of rank `middle` among the intervals, found among those that a sample says it is near; nothing where it is
/// not there. Hours of stamps need not be sorted.
std::optional<double> interval_of_rank(std::span<const double> times, std::size_t middle) {
  constexpr std::size_t kSample = 1024, kAround = 64;
  const std::size_t count = times.size() - 1;
  std::array<double, kSample> sample;
  for (std::size_t i = 0; i < kSample; ++i) {
    const std::size_t at = i * (count / kSample);
    sample[i] = times[at + 1] - times[at];
  }
  std::ranges::sort(sample);
  const double low = sample[kSample / 2 - kAround], high = sample[kSample / 2 + kAround];
  std::size_t below = 0, equal = 0;
  std::vector<double> near;
  for (std::size_t i = 0; i < count; ++i) {
    const double interval = times[i + 1] - times[i];
    below += interval < low ? 1U : 0U;
    if (low == high) {
      equal += interval == low ? 1U : 0U;
    } else if (interval >= low && interval <= high) {
      near.push_back(interval);
    }
  }
  if (middle >= below && middle - below < equal) return low;
  if (middle < below || middle - below >= near.size()) return std::nullopt;
  return value_of_rank(near, middle - below);
}

double median_interval(std::span<const double> times) {
  if (times.size() < 2) return 0.0;
  constexpr std::size_t kMany = 16384;
  if (times.size() > kMany) {
    if (const std::optional<double> found = interval_of_rank(times, (times.size() - 1) / 2)) return *found;
  }
  std::vector<double> intervals(times.size() - 1);
  for (std::size_t i = 0; i + 1 < times.size(); ++i) intervals[i] = times[i + 1] - times[i];
  return upper_median(intervals);
}

void check(const Channel& channel, const std::string& source) {
  const std::string place = fmt::format("{}: channel '{}'", source, channel.name);
  if (channel.name.empty()) throw InputError(source, "a channel has no name");
  if (channel.times().size() != channel.value.size()) {
    throw InputError(place, fmt::format("{} time stamps for {} values", channel.times().size(), channel.value.size()));
  }
  const auto times = channel.times();
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i])) throw InputError(place, fmt::format("time stamp {} is {}", i + 1, times[i]));
    if (i > 0 && times[i] < times[i - 1]) {
      throw InputError(place,
                       fmt::format("time goes backwards at sample {}: {} s after {} s", i + 1, times[i], times[i - 1]));
    }
  }
}

}  // namespace

TimeSpan Channel::span() const {
  const auto stamps = times();
  return stamps.empty() ? TimeSpan{} : TimeSpan{stamps.front(), stamps.back()};
}

double Channel::rate_Hz() const {
  const double interval = median_interval(times());
  return interval > 0.0 ? 1.0 / interval : 0.0;
}

std::vector<TimeSpan> Channel::gaps(double limit_s) const {
  const auto stamps = times();
  const double limit = limit_s > 0.0 ? limit_s : 5.0 * median_interval(stamps);
  std::vector<TimeSpan> found;
  std::size_t previous = stamps.size();
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (!std::isfinite(value[i])) continue;
    if (previous < stamps.size() && stamps[i] - stamps[previous] > limit)
      found.push_back({stamps[previous], stamps[i]});
    previous = i;
  }
  return found;
}

void Recording::add(Channel channel) {
  check(channel, source);
  if (has(channel.name)) throw InputError(source, fmt::format("channel '{}' appears twice", channel.name));
  index_.emplace(channel.name, channels_.size());
  channels_.push_back(std::move(channel));
}

void Recording::set(Channel channel) {
  if (const auto found = index_.find(channel.name); found != index_.end()) {
    check(channel, source);
    channels_[found->second] = std::move(channel);
  } else {
    add(std::move(channel));
  }
}

const Channel* Recording::find(std::string_view name) const {
  const auto found = index_.find(name);
  return found == index_.end() ? nullptr : &channels_[found->second];
}

const Channel& Recording::at(std::string_view name) const {
  if (const Channel* channel = find(name)) return *channel;
  throw InputError(source, fmt::format("no channel '{}'{}", name, suggestion(name, names())));
}

std::vector<std::string> Recording::names() const {
  std::vector<std::string> result;
  result.reserve(channels_.size());
  for (const Channel& channel : channels_) result.push_back(channel.name);
  return result;
}

TimeSpan Recording::span() const {
  TimeSpan whole;
  bool first = true;
  for (const Channel& channel : channels_) {
    if (channel.empty()) continue;
    const TimeSpan span = channel.span();
    whole.begin = first ? span.begin : std::min(whole.begin, span.begin);
    whole.end = first ? span.end : std::max(whole.end, span.end);
    first = false;
  }
  return whole;
}

TimeBase make_time_base(std::vector<double> stamps) {
  return std::make_shared<const std::vector<double>>(std::move(stamps));
}

Channel make_channel(std::string name, std::string_view unit, TimeBase time, std::vector<double> value) {
  const Unit si = parse_unit(unit).si();
  return Channel{std::move(name), si, std::string(unit), std::move(time), std::move(value)};
}

}  // namespace veridyn
