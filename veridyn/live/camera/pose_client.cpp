#include "veridyn/live/camera/pose_client.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace veridyn::live {
namespace {

/// An attempt to connect that has not come through after this is a new one [ns].
constexpr Nanoseconds kTriedApart = kSecond / 2;

}  // namespace

void PoseClient::close() {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
  begin_ = end_ = 0;
}

void PoseClient::connect(Nanoseconds now) {
  if (tried_ && now - tried_at_ < kTriedApart) return;
  tried_ = true;
  tried_at_ = now;
  socket_ = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (socket_ < 0) return;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(server_.address);
  address.sin_port = htons(server_.port);
  if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 && errno != EINPROGRESS)
    close();
}

std::optional<Datagram> PoseClient::next(Nanoseconds now) {
  if (socket_ < 0) connect(now);
  if (socket_ < 0) return std::nullopt;
  if (end_ - begin_ < kPosePacketBytes) {
    std::copy(buffer_.begin() + begin_, buffer_.begin() + end_, buffer_.begin());
    end_ -= begin_;
    begin_ = 0;
    const ssize_t n = ::recv(socket_, buffer_.data() + end_, buffer_.size() - end_, 0);
    if (n > 0) {
      end_ += static_cast<std::size_t>(n);
    } else if (n == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR && errno != ENOTCONN)) {
      close();
      return std::nullopt;
    }
  }
  if (end_ - begin_ < kPosePacketBytes) return std::nullopt;
  const std::string_view packet(buffer_.data() + begin_, kPosePacketBytes);
  begin_ += kPosePacketBytes;
  if (!packet.starts_with("VCP1")) {
    close();
    return std::nullopt;
  }
  return Datagram{.bytes = packet, .sender = server_, .arrival = now};
}

}  // namespace veridyn::live
