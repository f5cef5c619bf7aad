#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string>

namespace veridyn {

/// A browser of few words: one request to a page on loopback, and what comes back.
class PageReader {
 public:
  /// @param request with its headers, lines ended by \r\n, without the last empty one
  PageReader(int port, const std::string& request) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) return;
    const std::string all = request + "Host: 127.0.0.1:" + std::to_string(port) + "\r\n\r\n";
    static_cast<void>(::send(socket_, all.data(), all.size(), MSG_NOSIGNAL));
  }
  ~PageReader() { ::close(socket_); }
  PageReader(const PageReader&) = delete;
  PageReader& operator=(const PageReader&) = delete;

  void send(const std::string& text) const {
    static_cast<void>(::send(socket_, text.data(), text.size(), MSG_NOSIGNAL));
  }
  /// The next bytes; waits for them. Empty where there are no more.
  [[nodiscard]] std::string read() const {
    std::array<char, 65536> bytes{};
    const ssize_t n = ::recv(socket_, bytes.data(), bytes.size(), 0);
    return n > 0 ? std::string(bytes.data(), static_cast<std::size_t>(n)) : std::string();
  }
  /// Ends a `read` that waits.
  void hang_up() const { ::shutdown(socket_, SHUT_RDWR); }

 private:
  int socket_;
};

}  // namespace veridyn
