#pragma once

#include <cstdint>

namespace veridyn::live {

/// Time of a run in nanoseconds since the clock's own origin. Integers, so that a recorded run is replayed to the bit.
using Nanoseconds = std::int64_t;

inline constexpr Nanoseconds kSecond = 1'000'000'000;
inline constexpr Nanoseconds kMillisecond = 1'000'000;

/// Seconds, rounded to the nearest nanosecond.
Nanoseconds nanoseconds(double seconds);
inline double seconds(Nanoseconds time) { return static_cast<double>(time) * 1e-9; }

/// The one source of time of everything live: real, or set by a replay or a test.
class Clock {
 public:
  virtual ~Clock() = default;
  /// Never runs backwards, whatever happens to the time of day.
  virtual Nanoseconds now() = 0;
  /// Returns at `time` or later; at once where that has passed.
  virtual void sleep_until(Nanoseconds time) = 0;
};

/// The machine's monotonic clock (CLOCK_MONOTONIC): setting the time of day does not move it.
class RealClock final : public Clock {
 public:
  Nanoseconds now() override;
  void sleep_until(Nanoseconds time) override;
};

}  // namespace veridyn::live
