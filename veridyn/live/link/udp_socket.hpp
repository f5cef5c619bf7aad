#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "veridyn/live/link/datagram.hpp"

namespace veridyn::live {

/// A UDP socket (IPv4) that never blocks, its datagrams stamped by the kernel when they arrive. Nothing is allocated
/// after construction.
class UdpSocket {
 public:
  /// Bound to an address of this machine; port 0: any free one.
  /// @throws InputError with `place`: the port is in use, the address is not ours, no right to a port below 1024
  UdpSocket(const Sender& bound_to, std::string_view place);
  /// Sends to `peer`, takes only what comes from there.
  [[nodiscard]] static UdpSocket connected(const Sender& peer, std::string_view place);
  ~UdpSocket();
  UdpSocket(UdpSocket&&) noexcept;
  UdpSocket& operator=(UdpSocket&&) noexcept;

  /// The next datagram that is there, by the monotonic clock; its bytes are valid until the next call.
  std::optional<Datagram> receive();
  /// To the peer of a connected socket. @return whether the kernel took it
  bool send(std::string_view bytes);
  bool send_to(const Sender& to, std::string_view bytes);
  /// Waits until something is there or the time has come. @return whether something is there
  bool wait(Nanoseconds until);
  /// Address and port that it has.
  [[nodiscard]] Sender bound_to() const;
  /// To wait for several at once.
  [[nodiscard]] int handle() const;

 private:
  struct Socket;
  explicit UdpSocket(std::unique_ptr<Socket> socket);
  std::unique_ptr<Socket> socket_;
};

}  // namespace veridyn::live
