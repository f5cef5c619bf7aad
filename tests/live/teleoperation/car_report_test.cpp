#include "veridyn/live/teleoperation/car_report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/live/teleoperation/car_command.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::live {
namespace {

using numerics::RandomStream;

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
      *numbers[which] = bad;
      EXPECT_NE(what_is_wrong(report.sensors), "");
      encode_report(report, bytes);
      ReportPayload decoded = decode_report(bytes).value();
      EXPECT_EQ(what_is_wrong(decoded.sensors), what_is_wrong(report.sensors));
      list(decoded.sensors);
      for (int k = 0; k < 12; ++k) EXPECT_EQ(std::isnan(*numbers[k]), k == which);
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
