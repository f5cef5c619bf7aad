#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

#include "veridyn/live/link/udp_socket.hpp"
#include "veridyn/live/threads/timely_thread.hpp"

namespace veridyn {

/// A network between two programs on loopback that can be pulled: what comes in at one port goes on to another, answers
/// go back to whoever sent last.
class UdpRelay {
 public:
  UdpRelay(std::uint16_t from, std::uint16_t to)
      : in_({kLoopbackOfRelay, from}, "relay"),
        out_(live::UdpSocket::connected({kLoopbackOfRelay, to}, "relay")),
        thread_([this] { pass_on(); }) {}
  ~UdpRelay() {
    ended_ = true;
    thread_.join();
  }
  UdpRelay(const UdpRelay&) = delete;
  UdpRelay& operator=(const UdpRelay&) = delete;

  /// Pulled, or put back. What comes meanwhile is lost.
  void cut(bool pulled) { cut_ = pulled; }

 private:
  static constexpr std::uint32_t kLoopbackOfRelay = 0x7f000001;

  void pass_on() {
    static_cast<void>(live::make_thread_timely());
    live::RealClock clock;
    live::Sender last;
    while (!ended_) {
      in_.wait(clock.now() + live::kMillisecond);
      while (const auto d = in_.receive()) {
        last = d->sender;
        if (!cut_) out_.send(d->bytes);
      }
      while (const auto d = out_.receive()) {
        if (!cut_ && last.port != 0) in_.send_to(last, d->bytes);
      }
    }
  }

  live::UdpSocket in_, out_;
  std::atomic<bool> cut_{false}, ended_{false};
  std::thread thread_;
};

}  // namespace veridyn
