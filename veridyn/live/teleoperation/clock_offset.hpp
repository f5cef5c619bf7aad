#pragma once

#include <cstdint>
#include <optional>

#include "veridyn/live/time/clock.hpp"

namespace veridyn::live {

/// A quantity that is known to lie between two values [ns].
struct DelayBounds {
  Nanoseconds lowest = 0, highest = 0;

  [[nodiscard]] Nanoseconds width() const { return highest - lowest; }
};

/// What exchanges of stamps tell of the offset between two clocks, far = near + offset, and so of delays in one
/// direction.
///
/// A frame cannot arrive before it was sent: each one from near to far bounds the offset from above by (arrival, far) -
/// (sent, near), each one back bounds it from below. No more can be known: the interval is as wide as the shortest
/// delay out and the shortest delay back together, and where in it the offset lies depends on how these two share their
/// sum, which no exchange of stamps can tell. Between exchanges the interval widens by the drift of the clocks.
class ClockOffset {
 public:
  /// Fastest drift of two quartz clocks against each other [s/s].
  static constexpr double kDrift = 100e-6;

  /// A frame from near to far. @param arrived_far the latest that it can have been, where stamps are coarse
  /// @param now of the near clock
  void outward(Nanoseconds sent_near, Nanoseconds arrived_far, Nanoseconds now);
  /// A frame back. @param sent_far the earliest that it can have been
  void backward(Nanoseconds sent_far, Nanoseconds arrived_near, Nanoseconds now);
  void reset() { *this = {}; }

  /// Nothing before there was one in each direction.
  [[nodiscard]] std::optional<DelayBounds> offset(Nanoseconds now) const;
  /// How often the bounds contradicted each other and were found again: a clock was set or drifts faster.
  [[nodiscard]] std::uint64_t contradictions() const { return contradictions_; }

 private:
  struct Bound {
    Nanoseconds value = 0, at = 0;
  };
  void check(Nanoseconds now);

  std::optional<Bound> lowest_, highest_;
  std::uint64_t contradictions_ = 0;
};

}  // namespace veridyn::live
