#include "veridyn/live/teleoperation/clock_offset.hpp"

namespace veridyn::live {
namespace {

Nanoseconds drift_in(Nanoseconds time) { return nanoseconds(ClockOffset::kDrift * seconds(time)); }

}  // namespace

void ClockOffset::outward(Nanoseconds sent_near, Nanoseconds arrived_far, Nanoseconds now) {
  const Nanoseconds bound = arrived_far - sent_near;
  if (!highest_ || bound <= highest_->value + drift_in(now - highest_->at)) highest_ = Bound{bound, now};
  check(now);
}

void ClockOffset::backward(Nanoseconds sent_far, Nanoseconds arrived_near, Nanoseconds now) {
  const Nanoseconds bound = sent_far - arrived_near;
  if (!lowest_ || bound >= lowest_->value - drift_in(now - lowest_->at)) lowest_ = Bound{bound, now};
  check(now);
}

void ClockOffset::check(Nanoseconds now) {
  const std::optional<DelayBounds> bounds = offset(now);
  if (!bounds || bounds->width() >= 0) return;
  lowest_.reset();
  highest_.reset();
  ++contradictions_;
}

std::optional<DelayBounds> ClockOffset::offset(Nanoseconds now) const {
  if (!lowest_ || !highest_) return std::nullopt;
  return DelayBounds{.lowest = lowest_->value - drift_in(now - lowest_->at),
                     .highest = highest_->value + drift_in(now - highest_->at)};
}

}  // namespace veridyn::live
