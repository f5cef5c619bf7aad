#include "veridyn/io/ros/message_clock.hpp"

#include <cstdint>

#include "veridyn/core/rank.hpp"

namespace veridyn::io::internal {
namespace {

constexpr Nanoseconds kSecond = 1'000'000'000;
constexpr Nanoseconds kLeastDelay = -kSecond / 20, kMostDelay = 5 * kSecond, kJump = 10 * kSecond;

/// Differences wrap around where damaged stamps are far apart, instead of overflowing.
Nanoseconds difference(Nanoseconds a, Nanoseconds b) {
  return static_cast<Nanoseconds>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}

Nanoseconds sum(Nanoseconds a, Nanoseconds b) {
  return static_cast<Nanoseconds>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}

Nanoseconds least_delay(std::vector<Nanoseconds> delays) { return value_of_rank(delays, delays.size() / 100); }

}  // namespace

MessageTimes message_times(std::span<const Nanoseconds> stamps, std::span<const Nanoseconds> logged) {
  MessageTimes result;
  result.times.assign(logged.begin(), logged.end());
  std::vector<std::size_t> rows;
  std::vector<Nanoseconds> delays;
  std::size_t most_moved = 0;
  const auto finish_stretch = [&] {
    if (rows.empty()) return;
    const Nanoseconds least = least_delay(delays);
    const bool other = least < kLeastDelay || least > kMostDelay;
    for (const std::size_t i : rows) result.times[i] = other ? sum(stamps[i], least) : stamps[i];
    if (other) {
      result.moved += rows.size();
      if (rows.size() > most_moved) {
        most_moved = rows.size();
        result.moved_by = least;
      }
    }
    rows.clear();
    delays.clear();
  };
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (stamps[i] == MessageTable::kNoStamp) {
      ++result.without_stamp;
      continue;
    }
    const Nanoseconds delay = difference(logged[i], stamps[i]);
    if (!delays.empty()) {
      const Nanoseconds jump = difference(delay, delays.back());
      if (jump > kJump || jump < -kJump) finish_stretch();
    }
    rows.push_back(i);
    delays.push_back(delay);
  }
  finish_stretch();
  return result;
}

}  // namespace veridyn::io::internal
