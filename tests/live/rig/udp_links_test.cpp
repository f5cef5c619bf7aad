#include <gtest/gtest.h>

#ifdef VERIDYN_HAS_SOCKETS
#include "veridyn/live/platform/order_format.hpp"
#include "veridyn/live/rig/udp_links.hpp"
#include "veridyn/live/serial/pseudo_terminal.hpp"

namespace veridyn::live {
namespace {

constexpr std::uint32_t kLoopbackOfLinks = 0x7f000001;

/// A port that is free.
Sender free_port() { return UdpSocket({kLoopbackOfLinks, 0}, "test").bound_to(); }

TEST(UdpLinks, ReturnAtTheDeadlineWhateverIsThere) {
  UdpSocket platform({kLoopbackOfLinks, 0}, "test");
  const Sender telemetry = free_port();
  UdpLinks links(telemetry, platform.bound_to());
  UdpSocket vehicle = UdpSocket::connected(telemetry, "test");
  RealClock clock;
  ASSERT_TRUE(vehicle.send("packet"));
  const auto first = links.next(clock, clock.now() + kSecond);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->link, LinkOf::kTelemetry);
  EXPECT_EQ(first->datagram.bytes, "packet");
  ASSERT_TRUE(links.send("order"));
  ASSERT_TRUE(platform.wait(clock.now() + kSecond));
  const auto order = platform.receive();
  ASSERT_TRUE(order);
  EXPECT_EQ(order->bytes, "order");
  ASSERT_TRUE(platform.send_to(order->sender, "answer"));
  const auto answer = links.next(clock, clock.now() + kSecond);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->link, LinkOf::kPlatform);
  const Nanoseconds until = clock.now() + 5 * kMillisecond;
  EXPECT_FALSE(links.next(clock, until));
  EXPECT_GE(clock.now(), until);
  ASSERT_TRUE(vehicle.send("late"));
  EXPECT_FALSE(links.next(clock, clock.now() - 1));
}

TEST(UdpLinks, SendOrdersOnASerialLineAndTakeTelemetryMeanwhile) {
  PseudoTerminal platform;
  const Sender telemetry = free_port();
  UdpLinks links(telemetry, SerialOptions{.device = platform.device()});
  OrderFormat format({.kind = OrderFormatKind::kAmcAasd15a}, cueing::built_in_platform("hexapod"));
  PlatformOrder order;
  order.motion.shift.z() = 0.1;
  const std::string bytes(format.encode(order));
  ASSERT_EQ(bytes.size(), 20U);
  ASSERT_TRUE(links.send(bytes));
  const std::vector<std::uint8_t> got = platform.read(bytes.size());
  EXPECT_EQ(std::string(got.begin(), got.end()), bytes);
  UdpSocket vehicle = UdpSocket::connected(telemetry, "test");
  RealClock clock;
  ASSERT_TRUE(vehicle.send("packet"));
  const auto in = links.next(clock, clock.now() + kSecond);
  ASSERT_TRUE(in);
  EXPECT_EQ(in->datagram.bytes, "packet");
  EXPECT_FALSE(links.next(clock, clock.now() + kMillisecond));
}

}  // namespace
}  // namespace veridyn::live
#endif
