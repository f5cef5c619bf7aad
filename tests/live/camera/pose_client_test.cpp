#include "veridyn/live/camera/pose_client.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/refusal.hpp"
#include "veridyn/live/camera/pose_server.hpp"

namespace veridyn::live {
namespace {

/// A server and a client of this test's own port, on the real clock.
class PoseClientTest : public ::testing::Test {
 protected:
  PoseClientTest() : at_{0x7f000001, static_cast<std::uint16_t>(26000 + ::getpid() % 4000)} {}

  static PosePacket packet(std::uint32_t sequence) {
    CameraPose p{.sequence = sequence};
    p.covariance.setIdentity();
    return encode(p);
  }
  static void pause() { std::this_thread::sleep_for(std::chrono::milliseconds(20)); }
  /// Sends until the client has something, for 5 s at most. @return sequences of what came
  std::vector<std::uint32_t> until_received(PoseServer& server, PoseClient& client, std::uint32_t& sequence) {
    std::vector<std::uint32_t> got;
    for (int round = 0; round < 250 && got.size() < 3; ++round) {
      const PosePacket bytes = packet(sequence++);
      server.send({bytes.data(), bytes.size()});
      pause();
      while (const auto d = client.next(clock_.now())) got.push_back(decode_pose(d->bytes).value().sequence);
    }
    return got;
  }

  Sender at_;
  RealClock clock_;
};

TEST_F(PoseClientTest, ReceivesInOrderAndConnectsAgain) {
  PoseClient client(at_);
  EXPECT_FALSE(client.next(clock_.now()));  // nobody there yet
  std::uint32_t sequence = 1;
  for (int start = 0; start < 2; ++start) {
    PoseServer server(at_, "camera");
    const auto got = until_received(server, client, sequence);
    ASSERT_GE(got.size(), 3U) << "start " << start;
    for (std::size_t i = 1; i < got.size(); ++i) EXPECT_EQ(got[i], got[i - 1] + 1);
    EXPECT_EQ(server.receivers(), 1U);
  }
}

TEST_F(PoseClientTest, LeavesASenderOfSomethingElse) {
  PoseServer server(at_, "camera");
  PoseClient client(at_);
  std::uint32_t sequence = 1;
  ASSERT_GE(until_received(server, client, sequence).size(), 3U);
  server.send(std::string(kPosePacketBytes, 'x'));
  pause();
  EXPECT_FALSE(client.next(clock_.now()));
  EXPECT_EQ(client.handle(), -1);
  EXPECT_GE(until_received(server, client, sequence).size(), 3U) << "it connects again";
}

TEST_F(PoseClientTest, AReceiverThatDoesNotReadIsCutOff) {
  PoseServer server(at_, "camera");
  PoseClient reads(at_), sleeps(at_);
  std::uint32_t sequence = 1;
  static_cast<void>(sleeps.next(clock_.now()));
  ASSERT_GE(until_received(server, reads, sequence).size(), 3U);
  ASSERT_EQ(server.receivers(), 2U);
  // More than the kernel keeps for one that does not read.
  for (int k = 0; k < 200000 && server.receivers() == 2; ++k) {
    const PosePacket bytes = packet(sequence++);
    server.send({bytes.data(), bytes.size()});
    while (reads.next(clock_.now())) continue;
  }
  EXPECT_EQ(server.receivers(), 1U);
  EXPECT_THAT(why([&] { PoseServer(at_, "--serve"); }), ::testing::HasSubstr("cannot be listened to"));
}

}  // namespace
}  // namespace veridyn::live
