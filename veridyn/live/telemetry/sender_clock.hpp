#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "veridyn/live/time/clock.hpp"

namespace veridyn::live {

/// How a sender's stamps go with our clock. A packet arrives at its stamp, plus an offset, plus what it waited on the
/// way; the least of arrival minus stamp, over a second at a time, is the offset plus the shortest way. A line through
/// the last of them tells how the sender's clock drifts against ours. Nothing is allocated.
class SenderClock {
 public:
  /// @param stamp the sender's time of the packet [s]; @param arrival by our clock
  void add(double stamp, Nanoseconds arrival);
  /// Forgets everything: the sender began again.
  void reset() { *this = SenderClock(); }

  /// Our clock at a stamp of the sender's, for a packet that waited nowhere [s].
  [[nodiscard]] double ours(double stamp) const { return stamp + offset_; }
  /// Its inverse: what the sender's clock shows when ours does this [s].
  [[nodiscard]] double theirs(double ours) const { return ours - offset_; }
  /// By how much the packet came later than the quickest ones do [s].
  [[nodiscard]] double lateness(double stamp, Nanoseconds arrival) const { return seconds(arrival) - ours(stamp); }
  /// By how much the sender's clock runs slow (above zero) or fast against ours, 1e-6 is 1 ppm; NaN in the first ten
  /// seconds. Known to about the shortest way's variation over the time looked at, which is half a minute.
  [[nodiscard]] double drift() const;
  [[nodiscard]] bool begun() const { return begun_; }

 private:
  static constexpr std::size_t kBlocks = 32;
  struct Block {
    double at = 0.0;      ///< stamp of the quickest packet [s]
    double offset = 0.0;  ///< its arrival minus stamp [s]
  };

  std::array<Block, kBlocks> blocks_{};  ///< a ring of seconds
  std::size_t count_ = 0;                ///< blocks ended
  Block current_;
  double block_begin_ = 0.0, last_ = 0.0;  ///< stamps [s]
  double offset_ = 0.0;                    ///< in use: it follows the least one without a jump [s]
  bool begun_ = false;
};

/// What is said of a sender's clock that runs more than 100 ppm fast or slow; empty below that or where it is not
/// known.
[[nodiscard]] std::string drift_warning(double drift);

}  // namespace veridyn::live
