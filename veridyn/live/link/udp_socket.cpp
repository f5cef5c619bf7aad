#include "veridyn/live/link/udp_socket.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <time.h>

#include <array>
#include <asio/io_context.hpp>
#include <asio/ip/udp.hpp>
#include <cstring>

#include "veridyn/core/error.hpp"
#include "veridyn/live/link/arrival.hpp"

namespace veridyn::live {
namespace {

using asio::ip::udp;

udp::endpoint endpoint_of(const Sender& s) { return {asio::ip::address_v4(s.address), s.port}; }

Nanoseconds time_of(clockid_t which) {
  timespec t{};
  clock_gettime(which, &t);
  return static_cast<Nanoseconds>(t.tv_sec) * kSecond + t.tv_nsec;
}

Nanoseconds arrival_of(msghdr& message, Nanoseconds empty_at) {
  const Nanoseconds now = time_of(CLOCK_MONOTONIC);
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
    if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SCM_TIMESTAMPNS) continue;
    timespec stamp{};
    std::memcpy(&stamp, CMSG_DATA(c), sizeof stamp);
    return arrival_by_monotonic({.stamp = static_cast<Nanoseconds>(stamp.tv_sec) * kSecond + stamp.tv_nsec,
                                 .time_of_day = time_of(CLOCK_REALTIME),
                                 .now = now,
                                 .empty_at = empty_at});
  }
  return now;
}

}  // namespace

struct UdpSocket::Socket {
  asio::io_context context{1};
  udp::socket socket{context};
  std::array<char, 65536> bytes{};
  Nanoseconds empty_at = 0;  ///< when it was last seen to hold nothing
};

UdpSocket::UdpSocket(std::unique_ptr<Socket> socket) : socket_(std::move(socket)) {}
UdpSocket::~UdpSocket() = default;
UdpSocket::UdpSocket(UdpSocket&&) noexcept = default;
UdpSocket& UdpSocket::operator=(UdpSocket&&) noexcept = default;

UdpSocket::UdpSocket(const Sender& bound_to, std::string_view place) : socket_(std::make_unique<Socket>()) {
  asio::error_code error;
  udp::socket& s = socket_->socket;
  static_cast<void>(s.open(udp::v4(), error));
  if (!error) static_cast<void>(s.non_blocking(true, error));
  if (!error) static_cast<void>(s.bind(endpoint_of(bound_to), error));
  socket_->empty_at = time_of(CLOCK_MONOTONIC);
  if (error) throw InputError(place, fmt::format("{} cannot be listened to: {}", to_string(bound_to), error.message()));
  const int on = 1;
  ::setsockopt(s.native_handle(), SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
  const int buffer = 1 << 20;  // packets of a second, should the machine be busy
  ::setsockopt(s.native_handle(), SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer);
}

UdpSocket UdpSocket::connected(const Sender& peer, std::string_view place) {
  UdpSocket s(Sender{}, place);
  asio::error_code error;
  static_cast<void>(s.socket_->socket.connect(endpoint_of(peer), error));
  if (error) throw InputError(place, fmt::format("{} cannot be reached: {}", to_string(peer), error.message()));
  return s;
}

std::optional<Datagram> UdpSocket::receive() {
  sockaddr_in from{};
  iovec part{socket_->bytes.data(), socket_->bytes.size()};
  alignas(cmsghdr) std::array<char, 128> control{};
  msghdr message{};
  message.msg_name = &from;
  message.msg_namelen = sizeof from;
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  // The sender learns of a port that nobody listens to by an error of its next call: not of what is there to read.
  ssize_t n = -1;
  const Nanoseconds looked = time_of(CLOCK_MONOTONIC);
  for (int k = 0; k < 4 && n < 0; ++k) {
    n = ::recvmsg(socket_->socket.native_handle(), &message, MSG_DONTWAIT);
    if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) socket_->empty_at = looked;
    if (n < 0 && errno != ECONNREFUSED && errno != EINTR) return std::nullopt;
  }
  if (n < 0) return std::nullopt;
  Datagram d;
  d.bytes = {socket_->bytes.data(), static_cast<std::size_t>(n)};
  d.sender = {ntohl(from.sin_addr.s_addr), ntohs(from.sin_port)};
  d.arrival = arrival_of(message, socket_->empty_at);
  return d;
}

bool UdpSocket::send(std::string_view bytes) {
  for (int k = 0; k < 4; ++k) {
    if (::send(socket_->socket.native_handle(), bytes.data(), bytes.size(), MSG_DONTWAIT) >= 0) return true;
    if (errno != ECONNREFUSED && errno != EINTR) return false;
  }
  return false;
}

bool UdpSocket::send_to(const Sender& to, std::string_view bytes) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(to.address);
  address.sin_port = htons(to.port);
  return ::sendto(socket_->socket.native_handle(), bytes.data(), bytes.size(), MSG_DONTWAIT,
                  reinterpret_cast<const sockaddr*>(&address), sizeof address) >= 0;
}

bool UdpSocket::wait(Nanoseconds until) {
  const Nanoseconds left = until - time_of(CLOCK_MONOTONIC);
  if (left <= 0) return false;
  const timespec timeout{left / kSecond, left % kSecond};
  pollfd one{handle(), POLLIN, 0};
  return ::ppoll(&one, 1, &timeout, nullptr) > 0;
}

Sender UdpSocket::bound_to() const {
  asio::error_code error;
  const udp::endpoint e = socket_->socket.local_endpoint(error);
  return {e.address().to_v4().to_uint(), e.port()};
}

int UdpSocket::handle() const { return const_cast<udp::socket&>(socket_->socket).native_handle(); }

}  // namespace veridyn::live
