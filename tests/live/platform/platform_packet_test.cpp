#include "veridyn/live/platform/platform_packet.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "veridyn/core/bytes.hpp"
#include "veridyn/io/packets/crc32.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::live {
namespace {

PlatformOrder some_order() {
  PlatformOrder order;
  order.session = 0x01020304;
  order.sequence = 77;
  order.time = 1'234'567'890'123;
  order.state = RigState::kRunning;
  order.motion.shift = {0.1, -0.2, 0.3};
  order.motion.angle = {0.01, -0.02, 0.03};
  order.motion.velocity = {1.0, 2.0, 3.0};
  order.motion.rate = {-1.0, -2.0, -3.0};
  return order;
}

std::string_view view(const auto& bytes) { return {bytes.data(), bytes.size()}; }

TEST(PlatformOrder, LiesInItsPacketAsTheDocumentSays) {
  const OrderBytes bytes = encode(some_order());
  const std::string_view b = view(bytes);
  ASSERT_EQ(b.size(), 84U);
  EXPECT_EQ(b.substr(0, 4), "VPL1");
  EXPECT_EQ(number_at<std::uint32_t>(b, 4), 77U);
  EXPECT_EQ(number_at<std::int64_t>(b, 8), 1'234'567'890'123);
  EXPECT_EQ(number_at<std::uint32_t>(b, 16), 0x01020304U);
  EXPECT_EQ(b[20], 2);
  EXPECT_EQ(number_at<float>(b, 24), 0.1F);
  EXPECT_EQ(number_at<float>(b, 44), 0.03F);
  EXPECT_EQ(number_at<float>(b, 48), 1.0F);
  EXPECT_EQ(number_at<float>(b, 68), -3.0F);
  EXPECT_EQ(number_at<std::uint32_t>(b, 80), io::crc32(b.substr(0, 80)));
}

TEST(PlatformOrder, ComesOutAsItWentIn) {
  const PlatformOrder order = some_order();
  const auto back = decode_order(view(encode(order)));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->session, order.session);
  EXPECT_EQ(back->sequence, order.sequence);
  EXPECT_EQ(back->time, order.time);
  EXPECT_EQ(back->state, order.state);
  EXPECT_LT((back->motion.shift - order.motion.shift).norm(), 1e-7);
  EXPECT_LT((back->motion.rate - order.motion.rate).norm(), 1e-7);
}

TEST(PlatformAnswer, ComesOutAsItWentIn) {
  PlatformAnswer a;
  a.session = 9;
  a.sequence = 8;
  a.time = 7;
  a.verdict = PlatformVerdict::kCommandedByAnother;
  a.reached = {1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F};
  a.outside_limits = 11;
  const auto bytes = encode(a);
  ASSERT_EQ(bytes.size(), 56U);
  const auto back = decode_answer(view(bytes));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->verdict, a.verdict);
  EXPECT_EQ(back->reached, a.reached);
  EXPECT_EQ(back->outside_limits, 11U);
  EXPECT_FALSE(decode_order(view(bytes)));
}

TEST(PlatformAnswer, OfVersionTwoSaysWhoCommandsThePlatform) {
  PlatformAnswer a;
  a.session = 9;
  a.sequence = 8;
  a.verdict = PlatformVerdict::kCommandedByAnother;
  a.outside_limits = 11;
  a.commander = {0x7f000001, 4711};
  const auto bytes = encode(a);
  const std::string_view b = view(bytes);
  ASSERT_EQ(b.size(), 64U);
  EXPECT_EQ(b.substr(0, 4), "VPA2");
  EXPECT_EQ(number_at<std::uint32_t>(b, 48), 11U);
  EXPECT_EQ(number_at<std::uint32_t>(b, 52), 0x7f000001U);
  EXPECT_EQ(number_at<std::uint16_t>(b, 56), 4711U);
  EXPECT_EQ(number_at<std::uint32_t>(b, 60), io::crc32(b.substr(0, 60)));
  const auto back = decode_answer(b);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->commander, a.commander);
  EXPECT_EQ(back->verdict, a.verdict);
  EXPECT_EQ(back->outside_limits, 11U);
  EXPECT_FALSE(decode_answer(b.substr(0, 56)));
}

TEST(PlatformPackets, AnyByteThatIsWrongIsNoticed) {
  const OrderBytes good = encode(some_order());
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      OrderBytes bad = good;
      bad[i] = static_cast<char>(bad[i] ^ (1 << bit));
      EXPECT_FALSE(decode_order(view(bad))) << i << " " << bit;
    }
  }
  EXPECT_FALSE(decode_order(view(good).substr(0, 83)));
  EXPECT_FALSE(decode_order(""));
}

TEST(PlatformPackets, NumbersThatAreNotFiniteAreNoOrder) {
  PlatformOrder order = some_order();
  order.motion.angle.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(decode_order(view(encode(order))));
}

TEST(PlatformPackets, StandWhateverBytesCome) {
  numerics::RandomStream random(4, "bytes");
  std::string bytes;
  for (int k = 0; k < 10000; ++k) {
    bytes.resize(random.index(100));
    for (char& c : bytes) c = static_cast<char>(random.index(256));
    if (bytes.size() > 4 && k % 2 == 0)
      (k % 4 == 0 ? std::string_view("VPL1") : std::string_view("VPA1")).copy(bytes.data(), 4);
    EXPECT_FALSE(decode_order(bytes));
    EXPECT_FALSE(decode_answer(bytes));
  }
}

TEST(IsWithin, TakesALimitThatWasRoundedWithThePosition) {
  const cueing::PlatformLimits limits = cueing::three_axis_limits();
  cueing::PlatformState s;
  EXPECT_TRUE(is_within(s, limits));
  const auto axis = cueing::PlatformAxis::kPitch;
  set_axis(s, axis, {.position = limits[axis].highest, .rate = limits[axis].rate, .acceleration = 0.0});
  EXPECT_TRUE(is_within(s, limits));
  const auto sent = decode_order(view(encode([&] {
    PlatformOrder o;
    o.motion = s;
    return o;
  }())));
  EXPECT_TRUE(is_within(sent->motion, limits));
  set_axis(s, axis, {.position = limits[axis].highest * (1.0 + 1e-6), .rate = 0.0, .acceleration = 0.0});
  EXPECT_FALSE(is_within(s, limits));
  set_axis(s, axis, {.position = 0.0, .rate = 1.001 * limits[axis].rate, .acceleration = 0.0});
  EXPECT_FALSE(is_within(s, limits));
  set_axis(s, axis, {.position = std::nan(""), .rate = 0.0, .acceleration = 0.0});
  EXPECT_FALSE(is_within(s, limits));
  cueing::PlatformState surge;
  surge.shift.x() = 1e-6;  // an axis that this platform does not have
  EXPECT_FALSE(is_within(surge, limits));
}

}  // namespace
}  // namespace veridyn::live
