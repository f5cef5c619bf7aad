#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "veridyn/cueing/platform/platform_guard.hpp"
#include "veridyn/cueing/platform/platform_simulator.hpp"
#include "veridyn/live/link/datagram.hpp"
#include "veridyn/live/platform/platform_packet.hpp"

namespace veridyn::live {

/// A platform without hardware: follows orders with the dynamics of `cueing::PlatformSimulator`, answers each, counts
/// those that leave its limits, ask for a jump or for more than its acceleration, takes orders of one program at a
/// time, and leads itself to its neutral position where orders do not come. Knows nothing of clocks and sockets.
class VirtualPlatform {
 public:
  explicit VirtualPlatform(const cueing::Platform& platform);

  /// @return the answer to an order; nothing to what is none
  std::optional<PlatformAnswer> take(const Datagram& datagram);
  /// Where orders do not come, it moves by itself; to be called often.
  void step(Nanoseconds now);

  /// Its orders and what it did, since the beginning.
  struct Counts {
    std::uint64_t followed = 0;
    std::uint64_t outside = 0;   ///< beyond position or rate; not followed
    std::uint64_t jumps = 0;     ///< farther from the order before than the largest rate leads in the time between
    std::uint64_t too_hard = 0;  ///< its rate changes by more than the largest acceleration allows in that time
    std::uint64_t refused = 0;   ///< of a program that does not command it
    std::uint64_t old = 0;       ///< repeated or out of order
    std::uint64_t unreadable = 0;
    std::uint64_t silences = 0;  ///< orders did not come for longer than `kSilence`
  };
  [[nodiscard]] const Counts& counts() const { return counts_; }
  [[nodiscard]] const cueing::PlatformState& reached() const { return reached_; }
  [[nodiscard]] bool commanded() const { return session_.has_value(); }
  /// Who commands it, and who was last refused; texts for people.
  [[nodiscard]] std::string commander() const { return session_ ? to_string(commander_) : ""; }
  [[nodiscard]] std::string last_refused() const { return counts_.refused > 0 ? to_string(refused_) : ""; }

  static constexpr double kSilence = 0.2;  ///< [s]
  static constexpr double kFree = 2.0;     ///< without orders another program may command it [s]

 private:
  void judge(const PlatformOrder& order);
  void follow(const PlatformOrder& order);

  cueing::Platform platform_;
  cueing::PlatformGuard guard_;
  cueing::PlatformSimulator simulator_;
  cueing::PlatformState ordered_, reached_;
  std::optional<std::uint32_t> session_;
  Sender commander_, refused_;
  std::optional<PlatformOrder> last_order_;
  Nanoseconds last_arrival_ = 0, now_ = 0;
  bool silent_ = true, catches_up_ = false;
  Counts counts_;
};

}  // namespace veridyn::live
