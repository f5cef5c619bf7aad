#include "veridyn/live/camera/pose_server.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>

#include "tests/support/refusal.hpp"

namespace veridyn::live {
namespace {

/// A port of this process's own: tests run side by side.
const Sender kHere{0x7f000001, static_cast<std::uint16_t>(41000 + ::getpid() % 20000)};

/// A connection that receives, or -1.
class Receiver {
 public:
  Receiver() : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    const int small = 4096;
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
    const timeval patience{.tv_sec = 2, .tv_usec = 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(kHere.address);
    address.sin_port = htons(kHere.port);
    connected_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  ~Receiver() { ::close(socket_); }
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  [[nodiscard]] bool connected() const { return connected_; }
  /// As many bytes as were asked for; fewer where the connection ended.
  [[nodiscard]] std::string receive(std::size_t size) const {
    std::string bytes(size, '\0');
    const ssize_t got = ::recv(socket_, bytes.data(), size, MSG_WAITALL);
    bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return bytes;
  }

 private:
  int socket_;
  bool connected_ = false;
};

TEST(PoseServer, SendsEveryPacketToWhoeverIsConnected) {
  PoseServer server(kHere, "study.toml:3: poses");
  server.send("nobody hears this");
  EXPECT_EQ(server.receivers(), 0u);
  const Receiver first;
  ASSERT_TRUE(first.connected());
  server.send("one");
  EXPECT_EQ(server.receivers(), 1u);
  const Receiver second;
  ASSERT_TRUE(second.connected());
  server.send("two");
  EXPECT_EQ(server.receivers(), 2u);
  EXPECT_EQ(first.receive(6), "onetwo");
  EXPECT_EQ(second.receive(3), "two");
}

TEST(PoseServer, CutsOffWhoDoesNotKeepUpAndWhoIsGone) {
  PoseServer server(kHere, "study.toml:3: poses");
  const Receiver slow;
  {
    const Receiver gone;
    server.send("hello");
    EXPECT_EQ(server.receivers(), 2u);
  }
  // Nothing of it waits, however much is sent.
  const std::string large(1 << 16, 'x');
  for (int k = 0; k < 1000 && server.receivers() > 0; ++k) server.send(large);
  EXPECT_EQ(server.receivers(), 0u);
  const Receiver again;
  server.send("again");
  EXPECT_EQ(server.receivers(), 1u);
  EXPECT_EQ(again.receive(5), "again");
}

TEST(PoseServer, RefusesAPortInUseByNameAndPlace) {
  const PoseServer server(kHere, "study.toml:3: poses");
  const std::string refusal = why([] { PoseServer(kHere, "study.toml:9: poses"); });
  EXPECT_THAT(refusal, ::testing::HasSubstr("study.toml:9: poses"));
  EXPECT_THAT(refusal, ::testing::HasSubstr(to_string(kHere)));
  EXPECT_THAT(refusal, ::testing::HasSubstr("in use"));
}

}  // namespace
}  // namespace veridyn::live
