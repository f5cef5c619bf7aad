#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "veridyn/cueing/platform/platform_state.hpp"
#include "veridyn/live/link/datagram.hpp"
#include "veridyn/live/platform/rig_state.hpp"
#include "veridyn/live/time/clock.hpp"

namespace veridyn::live {

/// A command to a platform, as it goes over UDP: see docs/live.md for its bytes.
struct PlatformOrder {
  std::uint32_t session = 0;   ///< of the program that commands, drawn when it starts
  std::uint32_t sequence = 0;  ///< one more from packet to packet
  Nanoseconds time = 0;        ///< by the sender's clock
  RigState state = RigState::kParked;
  cueing::PlatformState motion;  ///< position and rate of each axis are sent, as floats
};

/// What the platform made of an order.
enum class PlatformVerdict : std::uint8_t {
  kFollows = 0,
  kCommandedByAnother = 1,  ///< another program commands it: this order was not followed
  kOutsideLimits = 2,       ///< the order left its limits: not followed
  kFault = 3,
};

/// The platform's answer to an order.
struct PlatformAnswer {
  std::uint32_t session = 0;   ///< of the order
  std::uint32_t sequence = 0;  ///< of the order
  Nanoseconds time = 0;        ///< of the order: what comes back tells the round trip
  PlatformVerdict verdict = PlatformVerdict::kFollows;
  cueing::PerPlatformAxis<float> reached = {};  ///< positions [m, rad]
  std::uint32_t outside_limits = 0;             ///< orders outside its limits so far
  Sender commander;                             ///< who commands it, where another program does; port 0: not said
};

inline constexpr std::size_t kOrderBytes = 84, kAnswerBytes = 56, kRefusalBytes = 64;
using OrderBytes = std::array<char, kOrderBytes>;

/// An answer's bytes: of 56, or of the 64 that say who commands the platform.
class AnswerBytes {
 public:
  explicit AnswerBytes(std::size_t size = kAnswerBytes) : size_(size) {}
  [[nodiscard]] char* data() { return bytes_.data(); }
  [[nodiscard]] const char* data() const { return bytes_.data(); }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  std::array<char, kRefusalBytes> bytes_{};
  std::size_t size_;
};

[[nodiscard]] OrderBytes encode(const PlatformOrder& order);
/// Of version 1, as every program knows it; of version 2 where it says who commands the platform.
[[nodiscard]] AnswerBytes encode(const PlatformAnswer& answer);
/// Nothing where size, start, version or CRC are wrong, a number is not finite or a state is none.
[[nodiscard]] std::optional<PlatformOrder> decode_order(std::string_view bytes);
[[nodiscard]] std::optional<PlatformAnswer> decode_answer(std::string_view bytes);

/// Whether positions and rates that were sent as floats lie within limits: the limits are rounded in the same way.
/// Axes that cannot move stand at 0. Never of NaN.
[[nodiscard]] bool is_within(const cueing::PlatformState& motion, const cueing::PlatformLimits& limits);

}  // namespace veridyn::live
