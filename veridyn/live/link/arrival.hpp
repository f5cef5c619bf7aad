#pragma once

#include <algorithm>

#include "veridyn/live/time/clock.hpp"

namespace veridyn::live {

/// What is known of when a datagram arrived, at the moment at which it is read.
struct ArrivalClues {
  Nanoseconds stamp = 0;        ///< the kernel's, by the time of day
  Nanoseconds time_of_day = 0;  ///< now
  Nanoseconds now = 0;          ///< the same moment by the monotonic clock
  Nanoseconds empty_at = 0;     ///< when the socket was last seen to hold nothing, by the monotonic clock
};

/// When a datagram arrived by the monotonic clock.
///
/// The kernel stamps by the time of day, which somebody may set at any moment: a stamp that says that the datagram came
/// before the socket was empty, or after now, is not taken, and the datagram counts as having come now. That is late
/// by what it waited, which an offset of clocks that follows the quickest packets does not see. A datagram on its way
/// into the socket while that was looked at has a stamp a little before: such a one counts from that moment on.
[[nodiscard]] inline Nanoseconds arrival_by_monotonic(const ArrivalClues& c) {
  constexpr Nanoseconds kOnItsWay = 2 * kMillisecond;
  const Nanoseconds arrival = c.now - (c.time_of_day - c.stamp);
  if (arrival > c.now || arrival < c.empty_at - kOnItsWay) return c.now;
  return std::max(arrival, c.empty_at);
}

}  // namespace veridyn::live
