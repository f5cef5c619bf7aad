#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/refusal.hpp"

#ifdef VERIDYN_HAS_SOCKETS
#include "veridyn/live/link/udp_socket.hpp"

namespace veridyn::live {
namespace {

using ::testing::HasSubstr;

constexpr std::uint32_t kLoopback = 0x7f000001;

TEST(UdpSocket, TakesWhatIsSentToItWithSenderAndTimeOfArrival) {
  UdpSocket in({kLoopback, 0}, "test");
  UdpSocket out = UdpSocket::connected(in.bound_to(), "test");
  RealClock clock;
  EXPECT_FALSE(in.receive());
  const Nanoseconds before = clock.now();
  ASSERT_TRUE(out.send("hello"));
  ASSERT_TRUE(in.wait(clock.now() + kSecond));
  const auto d = in.receive();
  ASSERT_TRUE(d);
  EXPECT_EQ(d->bytes, "hello");
  EXPECT_EQ(d->sender, out.bound_to());
  EXPECT_GE(d->arrival, before - kMillisecond);
  EXPECT_LE(d->arrival, clock.now());
  ASSERT_TRUE(in.send_to(d->sender, "back"));
  ASSERT_TRUE(out.wait(clock.now() + kSecond));
  EXPECT_EQ(out.receive()->bytes, "back");
}

TEST(UdpSocket, TheTimeOfArrivalIsThatOfTheKernelNotOfReading) {
  UdpSocket in({kLoopback, 0}, "test");
  UdpSocket out = UdpSocket::connected(in.bound_to(), "test");
  RealClock clock;
  // A machine that is busy may deliver late; one that stamps at reading does so every time.
  Nanoseconds least = kSecond;
  for (int k = 0; k < 20 && least > 20 * kMillisecond; ++k) {
    ASSERT_TRUE(out.send("hello"));
    const Nanoseconds sent = clock.now();
    clock.sleep_until(sent + 50 * kMillisecond);
    const auto d = in.receive();
    ASSERT_TRUE(d);
    least = std::min(least, d->arrival - sent);
  }
  EXPECT_LT(least, 20 * kMillisecond);
}

TEST(UdpSocket, GoesOnWhereNobodyListens) {
  UdpSocket out = [] {
    UdpSocket gone({kLoopback, 0}, "test");
    return UdpSocket::connected(gone.bound_to(), "test");
  }();
  for (int k = 0; k < 20; ++k) {
    out.send("hello");
    EXPECT_FALSE(out.receive());
  }
}

TEST(UdpSocket, RefusesAPortInUseAndAnAddressThatIsNotOurs) {
  UdpSocket in({kLoopback, 0}, "test");
  EXPECT_THAT(
      why([&] { UdpSocket(in.bound_to(), "live.telemetry"); }),
      HasSubstr("live.telemetry: " + to_string(in.bound_to()) + " cannot be listened to: Address already in use"));
  EXPECT_THAT(why([] {
                UdpSocket({0x08080808, 4123}, "live.telemetry");
              }),
              HasSubstr("live.telemetry: 8.8.8.8:4123 cannot be listened to: Cannot assign requested address"));
}

}  // namespace
}  // namespace veridyn::live
#endif
