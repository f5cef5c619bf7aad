#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/refusal.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/live/teleoperation/car_command.hpp"
#include "veridyn/live/teleoperation/car_report.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::live {
namespace {

using numerics::RandomStream;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

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

TEST(CarReport, RoundTripsWithinHalfAStep) {
  RandomStream random(2, "reports");
  std::array<std::uint8_t, kReportPayload> bytes;
  for (int k = 0; k < 10'000; ++k) {
    ReportPayload report;
    CarSensors& sensors = report.sensors;
    for (double& value : sensors.acceleration) value = random.uniform(-163.0, 163.0);
    for (double& value : sensors.rate) value = random.uniform(-32.7, 32.7);
    sensors.steering = random.uniform(-3.2, 3.2);
    for (double& value : sensors.wheel_speeds) value = random.uniform(-655.0, 655.0);
    sensors.battery = random.uniform(0.0, 65.5);
    report.time_us = static_cast<std::uint32_t>(random.index(std::uint64_t{1} << 32U));
    report.received = static_cast<std::uint16_t>(random.index(65536));
    report.state = static_cast<CarState>(random.index(3));
    if (k % 2 == 0)
      report.echo = Echo{.run = static_cast<std::uint16_t>(random.index(65536)), .sequence = 9, .age = 700'000};
    ASSERT_EQ(what_is_wrong(sensors), "");
    encode_report(report, bytes);
    const ReportPayload decoded = decode_report(bytes).value();
    ASSERT_TRUE(((decoded.sensors.acceleration - sensors.acceleration).array().abs() <= 0.002501).all());
    ASSERT_TRUE(((decoded.sensors.rate - sensors.rate).array().abs() <= 0.0005001).all());
    ASSERT_NEAR(decoded.sensors.steering, sensors.steering, 0.5001e-4);
    for (std::size_t wheel = 0; wheel < 4; ++wheel)
      ASSERT_NEAR(decoded.sensors.wheel_speeds[wheel], sensors.wheel_speeds[wheel], 0.010001);
    ASSERT_NEAR(decoded.sensors.battery, sensors.battery, 0.0005001);
    ASSERT_EQ(decoded.time_us, report.time_us);
    ASSERT_EQ(decoded.received, report.received);
    ASSERT_EQ(decoded.state, report.state);
    ASSERT_EQ(decoded.echo.has_value(), report.echo.has_value());
    if (report.echo) {
      ASSERT_EQ(decoded.echo->run, report.echo->run);
    }
  }
}

TEST(CarReport, WhatNoSensorDeliversIsNaNAndNothingElseIs) {
  std::array<std::uint8_t, kReportPayload> bytes;
  for (const double bad : {kNaN, kInfinity, -kInfinity, 1e6, -1e6}) {
    for (int which = 0; which < 12; ++which) {
      ReportPayload report;
      std::array<double*, 12> numbers;
      const auto list = [&](CarSensors& sensors) {
        numbers = {&sensors.acceleration[0], &sensors.acceleration[1], &sensors.acceleration[2],
                   &sensors.rate[0],         &sensors.rate[1],         &sensors.rate[2],
                   &sensors.steering,        &sensors.wheel_speeds[0], &sensors.wheel_speeds[1],
                   &sensors.wheel_speeds[2], &sensors.wheel_speeds[3], &sensors.battery};
      };
      list(report.sensors);
      *numbers[static_cast<std::size_t>(which)] = bad;
      EXPECT_NE(what_is_wrong(report.sensors), "");
      encode_report(report, bytes);
      ReportPayload decoded = decode_report(bytes).value();
      EXPECT_EQ(what_is_wrong(decoded.sensors), what_is_wrong(report.sensors));
      list(decoded.sensors);
      for (int k = 0; k < 12; ++k) EXPECT_EQ(std::isnan(*numbers[static_cast<std::size_t>(k)]), k == which);
    }
  }
}

TEST(CarReport, OfAnotherSizeOrStateIsNone) {
  std::array<std::uint8_t, kReportPayload> bytes;
  encode_report({}, bytes);
  EXPECT_TRUE(decode_report(bytes));
  EXPECT_FALSE(decode_report(Bytes(bytes).first(kReportPayload - 1)));
  bytes[30] = 3;  // after 4 + 6 + 6 + 2 + 8 + 2 + 2 bytes: the state
  EXPECT_FALSE(decode_report(bytes));
}

TEST(Payloads, OfAnyBytesAreWhatTheyEncodeTo) {
  RandomStream random(3, "bytes");
  for (int k = 0; k < 10'000; ++k) {
    std::vector<std::uint8_t> bytes(random.index(2) == 0 ? kCommandPayload : kReportPayload);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.index(256));
    if (bytes.size() == kReportPayload) bytes[30] %= 4;
    std::vector<std::uint8_t> again(bytes.size());
    if (const auto command = decode_command(bytes)) {
      encode_command(*command, again);
      if (!command->echo) std::fill_n(bytes.begin() + 6, 4, std::uint8_t{0});
      // A brake beyond 6.5 is one that no end takes, and so are the others beyond their limits.
      ASSERT_EQ(again, bytes) << k;
    } else if (const auto report = decode_report(bytes)) {
      encode_report(*report, again);
      if (!report->echo) std::fill_n(bytes.begin() + 31, 4, std::uint8_t{0});
      ASSERT_EQ(again, bytes) << k;
    } else {
      ASSERT_TRUE(bytes.size() == kReportPayload && bytes[30] == 3) << k;
    }
  }
}

}  // namespace
}  // namespace veridyn::live
