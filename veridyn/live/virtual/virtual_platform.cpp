#include "veridyn/live/virtual/virtual_platform.hpp"

#include <algorithm>
#include <cmath>

namespace veridyn::live {

using cueing::AxisState;
using cueing::kPlatformAxes;
using cueing::PlatformAxis;

VirtualPlatform::VirtualPlatform(const cueing::Platform& platform)
    : platform_(platform), guard_(platform.limits), simulator_(platform) {}

void VirtualPlatform::judge(const PlatformOrder& order) {
  if (!is_within(order.motion, platform_.limits)) ++counts_.outside;
  if (!last_order_ || silent_) return;
  const double dt = std::max(seconds(order.time - last_order_->time), 0.0);
  bool jumps = false, too_hard = false;
  for (std::size_t i = 0; i < kPlatformAxes; ++i) {
    const auto which = static_cast<PlatformAxis>(i);
    const AxisState now = axis(order.motion, which), before = axis(last_order_->motion, which);
    // Floats of positions of a metre or a radian are exact to 1e-7, those of rates as well.
    constexpr double kRounding = 1e-6;
    const cueing::AxisLimits& limits = platform_.limits.axes[i];
    jumps = jumps || std::abs(now.position - before.position) > limits.rate * dt + kRounding;
    too_hard = too_hard || std::abs(now.rate - before.rate) > limits.acceleration * dt + kRounding;
  }
  counts_.jumps += jumps ? 1U : 0U;
  counts_.too_hard += too_hard ? 1U : 0U;
}

void VirtualPlatform::follow(const PlatformOrder& order) {
  // Moved by the sender's time, which is even, not by that of arrival.
  const double dt = last_order_ && !silent_ ? std::clamp(seconds(order.time - last_order_->time), 0.0, kSilence) : 0.0;
  cueing::PlatformState ordered = order.motion;
  if (catches_up_) {
    // From where it went by itself it comes within its limits, and follows from there.
    ordered = guard_.step(order.motion, dt);
    bool there = dt > 0.0;
    for (std::size_t i = 0; i < kPlatformAxes; ++i) {
      const auto which = static_cast<PlatformAxis>(i);
      constexpr double kClose = 1e-3;  // [m or rad]
      there = there && std::abs(axis(ordered, which).position - axis(order.motion, which).position) < kClose;
    }
    catches_up_ = !there;
  }
  ordered_ = ordered;
  reached_ = simulator_.step(ordered, dt);
}

std::optional<PlatformAnswer> VirtualPlatform::take(const Datagram& datagram) {
  const std::optional<PlatformOrder> order = decode_order(datagram.bytes);
  if (!order) {
    ++counts_.unreadable;
    return std::nullopt;
  }
  PlatformAnswer answer;
  answer.session = order->session;
  answer.sequence = order->sequence;
  answer.time = order->time;
  if (session_ && *session_ != order->session && datagram.arrival - last_arrival_ < nanoseconds(kFree)) {
    ++counts_.refused;
    refused_ = datagram.sender;
    answer.verdict = PlatformVerdict::kCommandedByAnother;
    answer.commander = commander_;
  } else {
    if (session_ != order->session) last_order_.reset();
    session_ = order->session;
    commander_ = datagram.sender;
    last_arrival_ = datagram.arrival;
    if (last_order_ && order->sequence <= last_order_->sequence) {
      ++counts_.old;
    } else {
      const std::uint64_t outside = counts_.outside;
      judge(*order);
      if (counts_.outside > outside) {
        answer.verdict = PlatformVerdict::kOutsideLimits;
      } else {
        follow(*order);
        ++counts_.followed;
      }
      last_order_ = *order;
      silent_ = false;
    }
  }
  answer.outside_limits = static_cast<std::uint32_t>(counts_.outside);
  for (std::size_t i = 0; i < kPlatformAxes; ++i)
    answer.reached[i] = static_cast<float>(axis(reached_, static_cast<PlatformAxis>(i)).position);
  return answer;
}

void VirtualPlatform::step(Nanoseconds now) {
  const double dt = seconds(now - now_);
  now_ = now;
  if (!silent_ && now - last_arrival_ > nanoseconds(kSilence)) {
    silent_ = catches_up_ = true;
    ++counts_.silences;
    guard_.reset(ordered_);
    return;
  }
  if (!silent_ || !session_) return;
  // Gently to neutral, by itself.
  cueing::PlatformCommand desired;
  const double left = std::exp(-dt);
  desired.shift = left * ordered_.shift;
  desired.angle = left * ordered_.angle;
  ordered_ = guard_.step(desired, dt);
  reached_ = simulator_.step(ordered_, dt);
}

}  // namespace veridyn::live
