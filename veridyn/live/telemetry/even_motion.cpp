#include "veridyn/live/telemetry/even_motion.hpp"

#include <algorithm>

namespace veridyn::live {
namespace {

/// On the line through two samples, at `part` of the way from a to b; beyond b where it is above 1.
recording::MotionSample on_line(const recording::MotionSample& a, const recording::MotionSample& b, double part) {
  recording::MotionSample s = b;
  const auto line = [part](const auto& from, const auto& to) { return (from + part * (to - from)).eval(); };
  s.time = a.time + part * (b.time - a.time);
  s.force = line(a.force, b.force);
  s.rate = line(a.rate, b.rate);
  s.angular_acceleration = line(a.angular_acceleration, b.angular_acceleration);
  s.position = line(a.position, b.position);
  s.speed = a.speed + part * (b.speed - a.speed);
  // The arc of a to b, gone on beyond b.
  const Eigen::AngleAxisd turn(a.attitude.conjugate() * b.attitude);
  s.attitude = (a.attitude * Eigen::Quaterniond(Eigen::AngleAxisd(part * turn.angle(), turn.axis()))).normalized();
  return s;
}

}  // namespace

void EvenMotion::add(const Telemetry& telemetry) {
  if (telemetry.restarted) count_ = 0;
  kept_[next_] = telemetry;
  next_ = (next_ + 1) % kKept;
  count_ = std::min(count_ + 1, kKept);
}

std::optional<EvenSample> EvenMotion::at(Nanoseconds now, const SenderClock& clock) const {
  if (count_ == 0) return std::nullopt;
  const Telemetry& last = newest(0);
  const double theirs = clock.theirs(seconds(now)), desired = theirs - options_.delay;
  EvenSample even{
      .sample = last.sample, .arrival = last.arrival, .extrapolated = 0.0, .age = theirs - last.sample.time};
  if (count_ == 1) return even;
  if (desired >= last.sample.time) {
    const recording::MotionSample& before = newest(1).sample;
    even.extrapolated = std::min(desired - last.sample.time, options_.extrapolate);
    const double step = last.sample.time - before.time;
    // Two packets close together say nothing of where the motion leads.
    constexpr double kClose = 1e-3;
    if (step > kClose && even.extrapolated > 0.0)
      even.sample = on_line(before, last.sample, 1.0 + even.extrapolated / step);
    return even;
  }
  for (std::size_t back = 1; back < count_; ++back) {
    const Telemetry& older = newest(back);
    if (older.sample.time > desired) continue;
    const Telemetry& newer = newest(back - 1);
    const double part = (desired - older.sample.time) / (newer.sample.time - older.sample.time);
    even.sample = on_line(older.sample, newer.sample, part);
    even.arrival = newer.arrival;
    return even;
  }
  const Telemetry& oldest = newest(count_ - 1);
  even.sample = oldest.sample;
  even.arrival = oldest.arrival;
  return even;
}

}  // namespace veridyn::live
