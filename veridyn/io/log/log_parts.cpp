#include "veridyn/io/log/log_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::io {
namespace {

/// Stretches without a stamp that are longer than a pause, of one topic.
std::vector<TimeSpan> pauses_of(const std::vector<double>& stamps, double pause) {
  std::vector<TimeSpan> pauses;
  for (std::size_t i = 0; i + 1 < stamps.size(); ++i)
    if (stamps[i + 1] - stamps[i] > pause) pauses.push_back({stamps[i], stamps[i + 1]});
  return pauses;
}

/// What is left of pauses where another topic has stamps in them.
std::vector<TimeSpan> without(const std::vector<TimeSpan>& pauses, const std::vector<double>& stamps, double pause) {
  std::vector<TimeSpan> left;
  for (const TimeSpan& p : pauses) {
    double begin = p.begin;
    for (auto at = std::ranges::upper_bound(stamps, p.begin); at != stamps.end() && *at < p.end; ++at) {
      if (*at - begin > pause) left.push_back({begin, *at});
      begin = *at;
    }
    if (p.end - begin > pause) left.push_back({begin, p.end});
  }
  return left;
}

/// The topics with rows, that with the most first.
std::vector<const LogTopic*> topics_of(const Log& log) {
  std::vector<const LogTopic*> topics;
  for (const LogTopic& topic : log.topics)
    if (!topic.schema && topic.size() > 0) topics.push_back(&topic);
  std::ranges::stable_sort(topics, std::ranges::greater(), &LogTopic::size);
  return topics;
}

std::string in_words(const std::vector<TimeSpan>& parts) {
  constexpr std::size_t kListed = 12;
  // Without the sign of a zero.
  const auto tenths = [](double t) { return 0.1 * std::round(10.0 * t) + 0.0; };
  std::string text;
  for (std::size_t i = 0; i < std::min(parts.size(), kListed); ++i)
    text += fmt::format("{}part {} ({:.1f} s to {:.1f} s)", i == 0 ? "" : ", ", i + 1, tenths(parts[i].begin),
                        tenths(parts[i].end));
  if (parts.size() > kListed) text += fmt::format(" and {} more", parts.size() - kListed);
  return text;
}

}  // namespace

std::vector<TimeSpan> log_parts(const Log& log) {
  const std::vector<const LogTopic*> topics = topics_of(log);
  if (topics.empty()) return {};
  const std::vector<double>& most = *topics.front()->time;
  const double usual = (most.back() - most.front()) / static_cast<double>(most.size());
  const double pause = std::max(kPause_s, 20.0 * usual);
  std::vector<TimeSpan> pauses = pauses_of(most, pause);
  TimeSpan whole{most.front(), most.back()};
  for (const LogTopic* topic : topics) {
    const std::vector<double>& stamps = *topic->time;
    if (topic != topics.front()) pauses = without(pauses, stamps, pause);
    whole.begin = std::min(whole.begin, stamps.front());
    whole.end = std::max(whole.end, stamps.back());
  }
  // A restart parts without a pause.
  for (const double t : log.restarts) pauses.push_back({t, t});
  std::ranges::sort(pauses, {}, &TimeSpan::begin);
  std::vector<TimeSpan> parts;
  double begin = whole.begin;
  const auto add = [&](double from, double to) {
    if (to - from >= kShortestPart_s) parts.push_back({from, to});
  };
  for (const TimeSpan& p : pauses) {
    add(begin, p.begin);
    begin = std::max(begin, p.end);
  }
  add(begin, whole.end);
  return parts;
}

void choose_part(Log& log, std::size_t part) {
  if (log.part > 0) return;
  const std::vector<TimeSpan> parts = log_parts(log);
  if (part == 0) {
    if (parts.size() > 1)
      log.damage.notes.push_back(
          fmt::format("pauses or restarts part it: {}; all are read, `part = 1` in [data] takes "
                      "the first",
                      in_words(parts)));
    return;
  }
  if (part > parts.size() && !(part == 1 && parts.empty()))
    throw InputError(log.source, parts.size() < 2 ? fmt::format("has no part {}: nothing parts it", part)
                                                  : fmt::format("has no part {}: it has {}", part, in_words(parts)));
  log.part = part;
  if (parts.size() < 2) return;
  const TimeSpan& span = parts[part - 1];
  // A restart is the first moment of what comes after it.
  const double end =
      std::ranges::find(log.restarts, span.end) != log.restarts.end() ? std::nextafter(span.end, -kInfinity) : span.end;
  for (LogTopic& topic : log.topics) {
    if (topic.schema || !topic.time) continue;
    const std::vector<double>& stamps = *topic.time;
    const auto first = std::ranges::lower_bound(stamps, span.begin), last = std::ranges::upper_bound(stamps, end);
    for (LogField& field : topic.fields)
      field.values.keep(static_cast<std::size_t>(first - stamps.begin()),
                        static_cast<std::size_t>(last - stamps.begin()));
    topic.time = make_time_base(std::vector<double>(first, last));
  }
  std::erase_if(log.topics, [](const LogTopic& topic) { return !topic.schema && topic.time && topic.time->empty(); });
  std::erase_if(log.events, [&](const Event& event) { return !TimeSpan{span.begin, end}.contains(event.time); });
  log.damage.notes.push_back(fmt::format("part {} of {} is read: {}", part, parts.size(), in_words(parts)));
}

}  // namespace veridyn::io
