#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "veridyn/live/camera/pose_packet.hpp"
#include "veridyn/live/link/datagram.hpp"

namespace veridyn::live {

/// Receives packets of a `PoseServer`. Connects by itself, and again twice a second where nobody is there or what
/// comes is none of them. Never waits; nothing is allocated or thrown.
class PoseClient {
 public:
  explicit PoseClient(const Sender& server) : server_(server) {}
  ~PoseClient() { close(); }
  PoseClient(const PoseClient&) = delete;
  PoseClient& operator=(const PoseClient&) = delete;

  /// The next whole packet that is there; its bytes are valid until the next call. Bytes that begin otherwise than a
  /// packet end the connection.
  std::optional<Datagram> next(Nanoseconds now);
  /// To wait for it; -1 while not connected.
  [[nodiscard]] int handle() const { return socket_; }

 private:
  void connect(Nanoseconds now);
  void close();

  Sender server_;
  int socket_ = -1;
  Nanoseconds tried_at_ = 0;
  bool tried_ = false;
  std::array<char, 16 * kPosePacketBytes> buffer_{};
  std::size_t begin_ = 0, end_ = 0;
};

}  // namespace veridyn::live
