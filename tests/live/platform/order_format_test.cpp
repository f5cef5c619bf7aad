#include "veridyn/live/platform/order_format.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/refusal.hpp"
#include "veridyn/core/bytes.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::live {
namespace {

using ::testing::HasSubstr;
using std::string_literals::operator""s;

PlatformOrder order_of(double heave, double roll, double pitch) {
  PlatformOrder order;
  order.session = 1;
  order.sequence = 2;
  order.time = 3 * kSecond / 2;
  order.motion.shift.z() = heave;
  order.motion.angle = {roll, pitch, 0.0};
  return order;
}

std::string text_of(const std::string& text, const PlatformOrder& order) {
  OrderFormat format({.kind = OrderFormatKind::kFlypt, .text = text}, cueing::built_in_platform("three_axis"));
  return std::string(format.encode(order));
}

std::string refusal_of(const std::string& text) {
  return why([&] { static_cast<void>(text_of(text, {})); });
}

TEST(OrderFormat, OfTheProjectIsItsPacket) {
  OrderFormat format({}, cueing::built_in_platform("three_axis"));
  const PlatformOrder order = order_of(0.05, 0.1, -0.2);
  const OrderBytes bytes = encode(order);
  EXPECT_TRUE(format.own());
  EXPECT_EQ(format.encode(order), std::string_view(bytes.data(), bytes.size()));
  EXPECT_EQ(format.longest(), bytes.size());
}

TEST(OrderFormat, Motion68HasAnglesAsOrientationAndHeaveAsHeight) {
  OrderFormat format({.kind = OrderFormatKind::kMotion68}, cueing::built_in_platform("three_axis"));
  const std::string_view b = format.encode(order_of(0.05, 0.1, -0.2));
  ASSERT_EQ(b.size(), 68U);
  EXPECT_EQ(number_at<float>(b, 0), 1.5F);
  // Its heading is 90 deg where a layout's is zero; nose up and right side down are positive.
  EXPECT_NEAR(number_at<float>(b, 4), -kPi / 2.0, 1e-6);
  EXPECT_FLOAT_EQ(number_at<float>(b, 8), -0.2F);
  EXPECT_FLOAT_EQ(number_at<float>(b, 12), 0.1F);
  for (std::size_t at = 16; at < 52; at += 4) EXPECT_EQ(number_at<float>(b, at), 0.0F) << at;
  EXPECT_EQ(number_at<std::int32_t>(b, 60), 3277);  // 0.05 m of 65536
  EXPECT_EQ(number_at<std::int32_t>(b, 64), 0);
}

TEST(OrderFormat, StrokesOfSixLegsLieInTwentyBytes) {
  const cueing::Platform& platform = cueing::built_in_platform("hexapod");
  OrderFormat format({.kind = OrderFormatKind::kAmcAasd15a}, platform);
  std::string_view b = format.encode({});
  ASSERT_EQ(b.size(), 20U);
  const auto stroke = [&](std::size_t leg) {
    return 256U * static_cast<unsigned char>(b[2 + 2 * leg]) + static_cast<unsigned char>(b[3 + 2 * leg]);
  };
  EXPECT_EQ(b.substr(0, 2), "\xff\xff");
  EXPECT_EQ(b.substr(14), std::string_view("\0\0\0\0\x0a\x0d", 6));
  const cueing::AxisLimits& leg = platform.legs->leg;
  const double neutral = 65535.0 * -leg.lowest / (leg.highest - leg.lowest);
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(stroke(k), neutral, 0.51) << k;
  // Up by heave, every leg as far as the geometry says.
  PlatformOrder up;
  up.motion.shift.z() = 0.1;
  b = format.encode(up);
  const cueing::Legs legs(*platform.legs, platform.limits);
  for (std::size_t k = 0; k < 6; ++k) {
    const double length = legs.lengths(up.motion).position(k);
    EXPECT_GT(length, 0.0);
    EXPECT_NEAR(stroke(k), neutral + 65535.0 * length / (leg.highest - leg.lowest), 0.51) << k;
  }
}

TEST(OrderFormat, LegsThatThePlatformLacksStandInTheirMiddle) {
  OrderFormat format({.kind = OrderFormatKind::kAmcAasd15a}, cueing::built_in_platform("three_axis"));
  const std::string_view b = format.encode({});
  EXPECT_EQ(b.substr(8, 6), "\x80\x00\x80\x00\x80\x00"s);
}

TEST(OrderFormat, ALineOfTextHasUnitsAndDecimals) {
  const PlatformOrder order = order_of(0.0123, -3.0 * kPi / 180.0, 4.5 * kPi / 180.0);
  EXPECT_EQ(text_of("P={pitch:deg:.3f},R={roll:deg:.3f}\n", order), "P=4.500,R=-3.000\n");
  EXPECT_EQ(text_of("{heave:mm:.1f}|{heave:cm:.0f}|{heave}|{yaw:rad:.2f}", order), "12.3|1|0.012|0.00");
  EXPECT_EQ(text_of("{{{roll}}}", order), "{-0.052}");
  EXPECT_EQ(text_of("{roll:deg:.1f}", order_of(0.0, -1e-6, 0.0)), "0.0");
}

TEST(OrderFormat, RefusesATextThatItCannotWrite) {
  EXPECT_THAT(refusal_of("nothing"), HasSubstr("names no axis"));
  EXPECT_THAT(refusal_of("{pitsch}"), HasSubstr("is no axis: surge, sway, heave, roll, pitch, yaw"));
  EXPECT_THAT(refusal_of("{pitch:mm}"), HasSubstr("takes rad or deg"));
  EXPECT_THAT(refusal_of("{heave:deg}"), HasSubstr("takes m, cm or mm"));
  EXPECT_THAT(refusal_of("{heave:mm:3}"), HasSubstr("takes decimals as .0f to .9f"));
  EXPECT_THAT(refusal_of("{pitch"), HasSubstr("has a brace without its other one"));
  EXPECT_THAT(refusal_of("pitch}"), HasSubstr("has a brace without its other one"));
  EXPECT_THAT(refusal_of(std::string(600, 'x') + "{pitch}"), HasSubstr("at most 512 can be sent"));
  EXPECT_THAT(
      why([] {
        static_cast<void>(OrderFormat({.kind = OrderFormatKind::kAmcAasd15a}, cueing::built_in_platform("ideal")));
      }),
      HasSubstr("sends the strokes of legs; [platform] has none"));
}

TEST(OrderFormat, StaysWithinItsSizeWhateverIsTold) {
  numerics::RandomStream random(3, "orders");
  for (std::size_t i = 0; i < kOrderFormats; ++i) {
    OrderFormat format({.kind = static_cast<OrderFormatKind>(i)}, cueing::built_in_platform("hexapod"));
    for (int k = 0; k < 1000; ++k) {
      PlatformOrder order = order_of(random.uniform(-2.0, 2.0), random.uniform(-4.0, 4.0), random.uniform(-4.0, 4.0));
      order.time = k * kSecond;
      ASSERT_LE(format.encode(order).size(), format.longest());
    }
  }
}

}  // namespace
}  // namespace veridyn::live
