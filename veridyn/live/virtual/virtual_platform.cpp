#include "veridyn/live/virtual/virtual_platform.hpp"

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
  const double dt = seconds(order.time - last_order_->time);
  for (std::size_t i = 0; i < kPlatformAxes; ++i) {
    const auto which = static_cast<PlatformAxis>(i);
    const double way = axis(order.motion, which).position - axis(last_order_->motion, which).position;
    // Floats of positions of a metre or a radian are exact to 1e-7.
    constexpr double kRounding = 1e-6;
    if (std::abs(way) > platform_.limits.axes[i].rate * std::max(dt, 0.0) + kRounding) {
      ++counts_.jumps;
      break;
    }
  }
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
  for (std::size_t i = 0; i < kPlatformAxes; ++i)
    answer.reached[i] = static_cast<float>(axis(reached_, static_cast<PlatformAxis>(i)).position);
  if (session_ && *session_ != order->session && datagram.arrival - last_arrival_ < nanoseconds(kFree)) {
    ++counts_.refused;
    refused_ = datagram.sender;
    answer.verdict = PlatformVerdict::kCommandedByAnother;
    answer.outside_limits = static_cast<std::uint32_t>(counts_.outside);
    return answer;
  }
  if (session_ != order->session) last_order_.reset();
  session_ = order->session;
  commander_ = datagram.sender;
  last_arrival_ = datagram.arrival;
  if (last_order_ && order->sequence <= last_order_->sequence) {
    ++counts_.old;
  } else {
    const std::uint64_t outside = counts_.outside;
    judge(*order);
    if (counts_.outside > outside) answer.verdict = PlatformVerdict::kOutsideLimits;
    last_order_ = *order;
    silent_ = false;
    ++counts_.followed;
  }
  answer.outside_limits = static_cast<std::uint32_t>(counts_.outside);
  return answer;
}

void VirtualPlatform::step(Nanoseconds now) {
  const double dt = begun_ ? seconds(now - now_) : 0.0;
  begun_ = true;
  now_ = now;
  if (!silent_ && now - last_arrival_ > nanoseconds(kSilence)) {
    silent_ = true;
    ++counts_.silences;
  }
  // Whoever orders it, and where nobody does, its own guard leads the actuators; without orders gently to neutral.
  cueing::PlatformCommand wanted;
  if (!silent_) {
    wanted = last_order_->motion;
  } else {
    const cueing::PlatformState at = guard_.state();
    const double left = std::exp(-dt / 1.0);
    wanted.shift = left * at.shift;
    wanted.angle = left * at.angle;
  }
  reached_ = simulator_.step(guard_.step(wanted, dt), dt);
}

}  // namespace veridyn::live
