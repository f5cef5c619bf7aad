#include "veridyn/live/platform/platform_packet.hpp"

#include <cmath>

#include "veridyn/core/bytes.hpp"
#include "veridyn/io/packets/crc32.hpp"

namespace veridyn::live {
namespace {

using cueing::AxisState;
using cueing::kPlatformAxes;
using cueing::PlatformAxis;

constexpr std::string_view kOrderStart = "VPL1", kAnswerStart = "VPA1", kRefusalStart = "VPA2";
// Both begin alike: start, sequence, time, session, one byte, three of zero, six floats.
constexpr std::size_t kSequence = 4, kTime = 8, kSession = 16, kCode = 20, kPositions = 24, kRates = 48, kOutside = 48;
constexpr std::size_t kCommander = 52, kCommanderPort = 56;  // of version 2 of the answer

void seal(std::span<char> bytes, std::string_view start) {
  start.copy(bytes.data(), start.size());
  put_at(bytes, bytes.size() - 4, io::crc32({bytes.data(), bytes.size() - 4}));
}

/// What order and answer begin with.
template <typename Packet>
void put_packet_head(std::span<char> bytes, const Packet& packet) {
  put_at(bytes, kSequence, packet.sequence);
  put_at(bytes, kTime, packet.time);
  put_at(bytes, kSession, packet.session);
}

template <typename Packet>
Packet read_packet_head(std::string_view bytes) {
  Packet packet;
  packet.sequence = number_at<std::uint32_t>(bytes, kSequence);
  packet.time = number_at<Nanoseconds>(bytes, kTime);
  packet.session = number_at<std::uint32_t>(bytes, kSession);
  return packet;
}

bool is_sealed(std::string_view bytes, std::string_view start, std::size_t size) {
  return bytes.size() == size && bytes.starts_with(start) &&
         number_at<std::uint32_t>(bytes, size - 4) == io::crc32(bytes.substr(0, size - 4));
}

}  // namespace

OrderBytes encode(const PlatformOrder& order) {
  OrderBytes bytes{};
  const std::span<char> b(bytes);
  put_packet_head(b, order);
  put_at(b, kCode, static_cast<std::uint8_t>(order.state));
  for (std::size_t i = 0; i < kPlatformAxes; ++i) {
    const AxisState a = axis(order.motion, static_cast<PlatformAxis>(i));
    put_at(b, kPositions + 4 * i, static_cast<float>(a.position));
    put_at(b, kRates + 4 * i, static_cast<float>(a.rate));
  }
  // 8 bytes are left for what a later version of the same size may say.
  seal(b, kOrderStart);
  return bytes;
}

AnswerBytes encode(const PlatformAnswer& answer) {
  const bool says_who = answer.commander.port != 0;
  AnswerBytes bytes(says_who ? kRefusalBytes : kAnswerBytes);
  const std::span<char> b(bytes.data(), bytes.size());
  put_packet_head(b, answer);
  put_at(b, kCode, answer.verdict);
  for (std::size_t i = 0; i < kPlatformAxes; ++i) put_at(b, kPositions + 4 * i, answer.reached[i]);
  put_at(b, kOutside, answer.outside_limits);
  if (says_who) {
    put_at(b, kCommander, answer.commander.address);
    put_at(b, kCommanderPort, answer.commander.port);
  }
  seal(b, says_who ? kRefusalStart : kAnswerStart);
  return bytes;
}

std::optional<PlatformOrder> decode_order(std::string_view bytes) {
  if (!is_sealed(bytes, kOrderStart, kOrderBytes)) return std::nullopt;
  auto order = read_packet_head<PlatformOrder>(bytes);
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
  const bool says_who = is_sealed(bytes, kRefusalStart, kRefusalBytes);
  if (!says_who && !is_sealed(bytes, kAnswerStart, kAnswerBytes)) return std::nullopt;
  auto answer = read_packet_head<PlatformAnswer>(bytes);
  if (says_who)
    answer.commander = {number_at<std::uint32_t>(bytes, kCommander), number_at<std::uint16_t>(bytes, kCommanderPort)};
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
