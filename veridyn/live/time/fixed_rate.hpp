#pragma once

#include <cstdint>

#include "veridyn/live/time/clock.hpp"

namespace veridyn::live {

/// Absolute deadlines at an even rate: start + k period. A step that ends late does not move those after it; deadlines
/// that have passed by then are left out and counted.
class FixedRate {
 public:
  FixedRate(Nanoseconds start, Nanoseconds period) : next_(start), period_(period) {}

  [[nodiscard]] Nanoseconds next() const { return next_; }
  [[nodiscard]] Nanoseconds period() const { return period_; }
  /// The step of `next()` is done. @return deadlines left out
  std::uint64_t advance(Nanoseconds now) {
    next_ += period_;
    if (now < next_ + period_) return 0;
    const Nanoseconds missed = (now - next_) / period_;
    next_ += missed * period_;
    left_out_ += static_cast<std::uint64_t>(missed);
    return static_cast<std::uint64_t>(missed);
  }
  /// Since the beginning.
  [[nodiscard]] std::uint64_t left_out() const { return left_out_; }

 private:
  Nanoseconds next_;
  Nanoseconds period_;
  std::uint64_t left_out_ = 0;
};

}  // namespace veridyn::live
