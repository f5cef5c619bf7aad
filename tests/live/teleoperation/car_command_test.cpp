#include "veridyn/live/teleoperation/car_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <optional>

#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::live {
namespace {

using numerics::RandomStream;

TEST(CarCommand, IsAsSpecifiedToTheByte) {
  std::array<std::uint8_t, kCommandPayload> bytes;
  encode_command({.command = {.steering = -0.1, .drive_force = 12.8, .brake = 0.5},
                  .echo = Echo{.run = 0x0102, .sequence = 0x0304, .age = 12'345'678}},
                 bytes);
  // -1000 = 0xfc18; 256 = 0x0100; 5000 = 0x1388; 12.3 ms: 123 = 0x7b, rounded down.
  EXPECT_THAT(bytes, ::testing::ElementsAre(0x18, 0xfc, 0x00, 0x01, 0x88, 0x13, 0x02, 0x01, 0x04, 0x03, 0x7b, 0x00));
  const CommandPayload decoded = decode_command(bytes).value();
  EXPECT_DOUBLE_EQ(decoded.command.steering, -0.1);
  EXPECT_DOUBLE_EQ(decoded.command.drive_force, 12.8);
  EXPECT_DOUBLE_EQ(decoded.command.brake, 0.5);
  EXPECT_EQ(decoded.echo.value().run, 0x0102);
  EXPECT_EQ(decoded.echo.value().sequence, 0x0304);
  EXPECT_EQ(decoded.echo.value().age, 12'300'000);
  EXPECT_FALSE(decode_command(Bytes(bytes).first(11)));
}

TEST(CarCommand, RoundTripsWithinHalfAStep) {
  RandomStream random(1, "commands");
  std::array<std::uint8_t, kCommandPayload> bytes;
  const CommandRange range{.steering = 3.2, .drive_force = 1600.0};
  for (int k = 0; k < 10'000; ++k) {
    const CarCommand command{.steering = random.uniform(-3.2, 3.2),
                             .drive_force = random.uniform(-1600.0, 1600.0),
                             .brake = random.uniform(0.0, 1.0)};
    encode_command({.command = command, .echo = std::nullopt}, bytes);
    const CommandPayload decoded = decode_command(bytes).value();
    ASSERT_NEAR(decoded.command.steering, command.steering, 0.5001e-4);
    ASSERT_NEAR(decoded.command.drive_force, command.drive_force, 0.02501);
    ASSERT_NEAR(decoded.command.brake, command.brake, 0.5001e-4);
    ASSERT_FALSE(decoded.echo);
    // What one end takes for good the other one does too.
    ASSERT_EQ(what_is_wrong(command, range), "");
    ASSERT_EQ(what_is_wrong(decoded.command, range), "");
  }
}

TEST(CarCommand, OnTheLimitPassesBothEnds) {
  std::array<std::uint8_t, kCommandPayload> bytes;
  for (const double steering : {0.6, 0.61237, 0.1 + 0.2, 3.2}) {
    for (const double drive_force : {100.0, 33.333, 1600.0}) {
      const CommandRange range{.steering = steering, .drive_force = drive_force};
      for (const double sign : {-1.0, 1.0}) {
        const CarCommand command{.steering = sign * steering, .drive_force = sign * drive_force, .brake = 1.0};
        EXPECT_EQ(what_is_wrong(command, range), "");
        encode_command({.command = command, .echo = std::nullopt}, bytes);
        EXPECT_EQ(what_is_wrong(decode_command(bytes).value().command, range), "");
      }
    }
  }
}

TEST(CarCommand, OutOfRangeIsNamed) {
  const CommandRange range{.steering = 0.6, .drive_force = 100.0};
  for (const double bad : {kNaN, kInfinity, -kInfinity, 1e300}) {
    EXPECT_EQ(what_is_wrong({.steering = bad}, range), "steering");
    EXPECT_EQ(what_is_wrong({.drive_force = bad}, range), "drive_force");
    EXPECT_EQ(what_is_wrong({.brake = bad}, range), "brake");
  }
  EXPECT_EQ(what_is_wrong({.steering = 0.6002}, range), "steering");
  EXPECT_EQ(what_is_wrong({.drive_force = -100.06}, range), "drive_force");
  EXPECT_EQ(what_is_wrong({.brake = -0.001}, range), "brake");
  EXPECT_EQ(what_is_wrong({.brake = 1.001}, range), "brake");
  EXPECT_EQ(why([] { CommandRange{.steering = kNaN}.validate(); }),
            "range.steering: is nan rad; must be > 0 and <= 3.2");
  EXPECT_EQ(why([] { CommandRange{.drive_force = 2000.0}.validate(); }),
            "range.drive_force: is 2000 N; must be > 0 and <= 1600");
}

TEST(CarCommand, AnEchoThatIsTooOldIsNone) {
  std::array<std::uint8_t, kCommandPayload> bytes;
  const auto age = [&](Nanoseconds sent) -> std::optional<Nanoseconds> {
    encode_command({.command = {}, .echo = Echo{.run = 1, .sequence = 2, .age = sent}}, bytes);
    const std::optional<Echo> echo = decode_command(bytes).value().echo;
    return echo ? std::optional(echo->age) : std::nullopt;
  };
  EXPECT_EQ(age(0), 0);
  EXPECT_EQ(age(99'999), 0);
  EXPECT_EQ(age(6'553'499'999), 6'553'400'000);
  EXPECT_EQ(age(6'553'500'000), std::nullopt);
  EXPECT_EQ(age(INT64_MAX), std::nullopt);
  EXPECT_EQ(age(-1), std::nullopt);
}

}  // namespace
}  // namespace veridyn::live
