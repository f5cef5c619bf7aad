#include "veridyn/live/camera/pose_server.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "veridyn/core/error.hpp"

namespace veridyn::live {

PoseServer::PoseServer(const Sender& bound_to, std::string_view place) {
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int yes = 1;
  ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(bound_to.address);
  address.sin_port = htons(bound_to.port);
  if (listener_ < 0 || ::bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(listener_, 8) != 0) {
    const std::string why = std::strerror(errno);
    if (listener_ >= 0) ::close(listener_);
    throw InputError(std::string(place), fmt::format("= '{}' cannot be listened to: {}", to_string(bound_to), why));
  }
}

PoseServer::~PoseServer() {
  for (const int client : clients_) ::close(client);
  ::close(listener_);
}

void PoseServer::send(std::string_view packet) {
  for (int client; (client = ::accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)) >= 0;) {
    const int yes = 1;  // each packet at once
    ::setsockopt(client, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    clients_.push_back(client);
  }
  std::erase_if(clients_, [&](int client) {
    const bool whole =
        ::send(client, packet.data(), packet.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(packet.size());
    if (!whole) ::close(client);
    return !whole;
  });
}

}  // namespace veridyn::live
