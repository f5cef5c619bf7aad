#include "veridyn/live/link/datagram.hpp"

#include <gtest/gtest.h>

#include <set>

namespace veridyn::live {
namespace {

TEST(Sender, IsWrittenAsOneReadsIt) {
  EXPECT_EQ(to_string(Sender{0x7f000001, 4123}), "127.0.0.1:4123");
  EXPECT_EQ(to_string(Sender{0xc0a801ff, 65535}), "192.168.1.255:65535");
  EXPECT_EQ(to_string(Sender{}), "0.0.0.0:0");
}

TEST(Sender, IsOfThisMachineOnAnyAddressOfTheLoopback) {
  EXPECT_TRUE(is_loopback({0x7f000001, 1}));
  EXPECT_TRUE(is_loopback({0x7fffffff, 1}));
  EXPECT_FALSE(is_loopback({0x80000001, 1}));
  EXPECT_FALSE(is_loopback({0x7e000001, 1}));
  EXPECT_FALSE(is_loopback({}));
}

TEST(Sender, DiffersByAddressAndByPort) {
  const std::set<Sender> senders{{1, 1}, {1, 2}, {2, 1}, {1, 1}};
  EXPECT_EQ(senders.size(), 3u);
}

}  // namespace
}  // namespace veridyn::live
