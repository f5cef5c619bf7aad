#include "veridyn/live/platform/platform_packet.hpp"

#include <cmath>

#include "veridyn/live/link/bytes.hpp"
#include "veridyn/live/link/crc32.hpp"

namespace veridyn::live {
namespace {

using cueing::AxisState;
using cueing::kPlatformAxes;
using cueing::PlatformAxis;

constexpr std::string_view kOrderStart = "VPL1", kAnswerStart = "VPA1";
// Both begin alike: start, sequence, time, session, one byte, three of zero, six floats.
constexpr std::size_t kSequence = 4, kTime = 8, kSession = 16, kCode = 20, kPositions = 24, kRates = 48, kOutside = 48;

template <std::size_t kBytes>
void seal(std::array<char, kBytes>& bytes, std::string_view start) {
  start.copy(bytes.data(), start.size());
  put_at(std::span(bytes), kBytes - 4, crc32({bytes.data(), kBytes - 4}));
}

bool is_sealed(std::string_view bytes, std::string_view start, std::size_t size) {
  return bytes.size() == size && bytes.starts_with(start) &&
         number_at<std::uint32_t>(bytes, size - 4) == crc32(bytes.substr(0, size - 4));
}

}  // namespace

OrderBytes encode(const PlatformOrder& order) {
  OrderBytes bytes{};
  const std::span<char> b(bytes);
  put_at(b, kSequence, order.sequence);
  put_at(b, kTime, order.time);
  put_at(b, kSession, order.session);
  put_at(b, kCode, static_cast<std::uint8_t>(order.state));
  for (std::size_t i = 0; i < kPlatformAxes; ++i) {
    const AxisState a = axis(order.motion, static_cast<PlatformAxis>(i));
    put_at(b, kPositions + 4 * i, static_cast<float>(a.position));
    put_at(b, kRates + 4 * i, static_cast<float>(a.rate));
  }
  // 8 bytes are left for what a later version of the same size may say.
  seal(bytes, kOrderStart);
  return bytes;
}

AnswerBytes encode(const PlatformAnswer& answer) {
  AnswerBytes bytes{};
  const std::span<char> b(bytes);
  put_at(b, kSequence, answer.sequence);
  put_at(b, kTime, answer.time);
  put_at(b, kSession, answer.session);
  put_at(b, kCode, answer.verdict);
  for (std::size_t i = 0; i < kPlatformAxes; ++i) put_at(b, kPositions + 4 * i, answer.reached[i]);
  put_at(b, kOutside, answer.outside_limits);
  seal(bytes, kAnswerStart);
  return bytes;
}

std::optional<PlatformOrder> decode_order(std::string_view bytes) {
  if (!is_sealed(bytes, kOrderStart, kOrderBytes)) return std::nullopt;
  PlatformOrder order;
  order.sequence = number_at<std::uint32_t>(bytes, kSequence);
  order.time = number_at<Nanoseconds>(bytes, kTime);
  order.session = number_at<std::uint32_t>(bytes, kSession);
  const auto state = number_at<std::uint8_t>(bytes, kCode);
  if (state >= kRigStates) return std::nullopt;
  order.state = static_cast<RigState>(state);
  for (std::size_t i = 0; i < kPlatformAxes; ++i) {
    const AxisState a{.position = number_at<float>(bytes, kPositions + 4 * i),
                      .rate = number_at<float>(bytes, kRates + 4 * i),
                      .acceleration = 0.0};
    if (!std::isfinite(a.position) || !std::isfinite(a.rate)) return std::nullopt;
    set_axis(order.motion, static_cast<PlatformAxis>(i), a);
  }
  return order;
}

std::optional<PlatformAnswer> decode_answer(std::string_view bytes) {
  if (!is_sealed(bytes, kAnswerStart, kAnswerBytes)) return std::nullopt;
  PlatformAnswer answer;
  answer.sequence = number_at<std::uint32_t>(bytes, kSequence);
  answer.time = number_at<Nanoseconds>(bytes, kTime);
  answer.session = number_at<std::uint32_t>(bytes, kSession);
  const auto verdict = number_at<std::uint8_t>(bytes, kCode);
  if (verdict > static_cast<std::uint8_t>(PlatformVerdict::kFault)) return std::nullopt;
  answer.verdict = static_cast<PlatformVerdict>(verdict);
  for (std::size_t i = 0; i < kPlatformAxes; ++i) {
    answer.reached[i] = number_at<float>(bytes, kPositions + 4 * i);
    if (!std::isfinite(answer.reached[i])) return std::nullopt;
  }
  answer.outside_limits = number_at<std::uint32_t>(bytes, kOutside);
  return answer;
}

bool is_within(const cueing::PlatformState& motion, const cueing::PlatformLimits& limits) {
  for (std::size_t i = 0; i < kPlatformAxes; ++i) {
    const AxisState a = axis(motion, static_cast<PlatformAxis>(i));
    const cueing::AxisLimits& l = limits.axes[i];
    const float rate = l.moves() ? static_cast<float>(l.rate) : 0.0F;
    const auto position = static_cast<float>(a.position);
    if (!(position >= static_cast<float>(l.lowest) && position <= static_cast<float>(l.highest) &&
          std::abs(static_cast<float>(a.rate)) <= rate))
      return false;
  }
  return true;
}

}  // namespace veridyn::live
