#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "veridyn/io/ros/message_table.hpp"

namespace veridyn::io::internal {

/// Moments of the messages of one topic on the clock of their log.
struct MessageTimes {
  std::vector<Nanoseconds> times;
  std::size_t without_stamp = 0;  ///< messages whose own stamp is zero: they have the log's
  std::size_t moved = 0;          ///< messages whose stamps are on another clock
  Nanoseconds moved_by = 0;       ///< of most of these
};

/// Takes the stamp that each message holds itself, which is when it was measured; the log's where it holds none.
///
/// No message is logged before it was measured, nor much later: where the least delay of a stretch (its first
/// hundredth, so that a damaged stamp does not count) is not between -50 ms and 5 s, its stamps are on another clock (a
/// sensor's, a simulation's, another computer's), and are moved so that the least delay is none. A stretch ends where
/// the delay jumps by more than 10 s: that clock was set, or began again.
[[nodiscard]] MessageTimes message_times(std::span<const Nanoseconds> stamps, std::span<const Nanoseconds> logged);

}  // namespace veridyn::io::internal
