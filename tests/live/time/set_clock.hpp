#pragma once

#include "veridyn/live/time/clock.hpp"

namespace veridyn::live {

/// A clock that stands until it is set: sleeping until a time sets it to that time.
class SetClock final : public Clock {
 public:
  explicit SetClock(Nanoseconds start = 0) : now_(start) {}
  Nanoseconds now() override { return now_; }
  void sleep_until(Nanoseconds time) override { set(time); }
  void set(Nanoseconds time) { now_ = time > now_ ? time : now_; }

 private:
  Nanoseconds now_;
};

}  // namespace veridyn::live
