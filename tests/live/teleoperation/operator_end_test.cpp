#include "veridyn/live/teleoperation/operator_end.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/live/teleoperation/simulated_loop.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/sanitized.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::live {
namespace {

using testing::SimulatedLoop;

TEST(OperatorEnd, SeesTheCarsSensors) {
  SimulatedLoop loop;
  loop.sensors = {.acceleration = {0.5, -1.25, 9.81}, .rate = {0.1, 0.0, -0.3}, .steering = 0.05, .battery = 7.4};
  loop.sensors.wheel_speeds = {10.0, 10.2, 9.8, 10.04};
  loop.run(0.1);
  ASSERT_TRUE(loop.operator_end->report());
  const ReceivedReport& report = *loop.operator_end->report();
  EXPECT_EQ(report.fault, "");
  EXPECT_NEAR(report.payload.sensors.acceleration.z(), 9.81, 0.0025);
  EXPECT_NEAR(report.payload.sensors.wheel_speeds[3], 10.04, 1e-9);
  EXPECT_EQ(report.payload.state, CarState::kHolding);
  // 52 bytes of 40 us after a report at 3 ms, 13 ms, ...
  EXPECT_EQ(report.arrived % (10 * kMillisecond), 5'100'000);
  loop.sensors.rate.y() = kNaN;
  loop.run(0.1);
  EXPECT_EQ(loop.operator_end->report()->fault, "rate");
  EXPECT_TRUE(std::isnan(loop.operator_end->report()->payload.sensors.rate.y()));
}

TEST(OperatorEnd, DoesNotSendWhatIsNoCommand) {
  OperatorEnd driver({}, 1);
  std::array<std::uint8_t, kLongestFrame> frame;
  EXPECT_EQ(driver.command({.steering = kNaN}, 0, frame), 0U);
  EXPECT_EQ(driver.command({.drive_force = 101.0}, 0, frame), 0U);
  EXPECT_EQ(driver.refused(), 2U);
  EXPECT_EQ(driver.command({}, 0, std::span(frame).first(20)), 0U);
  EXPECT_EQ(driver.command({}, 0, frame), frame_size(kCommandPayload));
  EXPECT_EQ(driver.quality(0).commands_sent, 1U);
  EXPECT_EQ(why([] { OperatorEnd({.lost_after = 0}, 1); }), "lost_after: is 0 s; must be > 0");
  EXPECT_EQ(why([] { OperatorEnd({.range = {.drive_force = 0.0}}, 1); }),
            "range.drive_force: is 0 N; must be > 0 and <= 1600");
}

TEST(OperatorEnd, CountsWhatWasLostInEachDirection) {
  SimulatedLoop loop;
  loop.run(1.0);
  const LinkQuality before = loop.operator_end->quality(loop.now);
  EXPECT_TRUE(before.connected);
  EXPECT_EQ(before.commands_lost, 0U);
  EXPECT_EQ(before.reports_lost, 0U);
  EXPECT_EQ(before.commands_sent, 100U);
  EXPECT_EQ(before.commands_arrived, 99U);
  EXPECT_EQ(before.command_loss(), 0.0);

  loop.to_car.cut = true;
  loop.run(0.07);
  loop.to_car.cut = false;
  loop.run(0.5);
  loop.to_operator.cut = true;
  loop.run(0.13);
  loop.to_operator.cut = false;
  loop.run(0.5);
  const LinkQuality after = loop.operator_end->quality(loop.now);
  EXPECT_EQ(after.commands_lost, 7U);
  EXPECT_EQ(after.reports_lost, 13U);
  EXPECT_NEAR(after.command_loss(), 7.0 / 219.0, 1e-12);
  EXPECT_EQ(after.commands_arrived + after.commands_lost, 219U);

  loop.to_operator.cut = true;
  loop.run(0.3);
  EXPECT_FALSE(loop.operator_end->quality(loop.now).connected);
}

TEST(OperatorEnd, MeasuresTheRoundTrip) {
  SimulatedLoop loop;
  loop.to_car.delay = 20 * kMillisecond;
  loop.to_operator.delay = 5 * kMillisecond;
  loop.run(2.0);
  const LinkQuality quality = loop.operator_end->quality(loop.now);
  // 27 and 52 bytes, each arrival on steps of 0.1 ms: 1.1 and 2.1 ms; what the car held the command is rounded down to
  // 0.1 ms.
  for (const auto& time :
       {quality.round_trip_last, quality.round_trip_least, quality.round_trip_median, quality.round_trip_p99}) {
    ASSERT_TRUE(time);
    EXPECT_NEAR(static_cast<double>(*time), 28.2e6, 0.1e6);
  }
}

TEST(OperatorEnd, BoundsOneWayDelaysAndNeverClaimsMore) {
  // Uneven delays, clocks that drift 80 ppm against each other, losses: the truth is always within.
  for (const double drift : {-80e-6, 0.0, 80e-6}) {
    SimulatedLoop loop(0.01);
    loop.car_drift = drift;
    loop.to_car.delay = 15 * kMillisecond;
    loop.to_operator.delay = 3 * kMillisecond;
    numerics::RandomStream random(4, "delays");
    int seen = 0;
    for (int k = 0; k < 300; ++k) {
      loop.run(0.1);
      const LinkQuality quality = loop.operator_end->quality(loop.now);
      if (!quality.clock_offset) continue;
      // Reports hold the lowest 32 bits of the car's microseconds.
      const Nanoseconds wrap = (Nanoseconds{1} << 32U) * 1000;
      const Nanoseconds truth = loop.car_time() - loop.now - loop.car_clock / wrap * wrap;
      EXPECT_LE(quality.clock_offset->lowest, truth);
      EXPECT_GE(quality.clock_offset->highest, truth);
      EXPECT_LE(quality.clock_offset->width(), *quality.round_trip_least + kMillisecond);
      ASSERT_TRUE(quality.command_delay && quality.report_delay);
      // On steps of 0.1 ms 16.1 and 5.1 ms.
      if (k < 200) {
        EXPECT_LE(quality.command_delay->lowest, 16'200'000);
        EXPECT_GE(quality.command_delay->highest, 16'000'000);
        EXPECT_LE(quality.report_delay->lowest, 5'100'000);
        EXPECT_GE(quality.report_delay->highest, 5'000'000);
        ++seen;
      } else {
        loop.to_car.delay = static_cast<Nanoseconds>(random.index(30)) * kMillisecond;
        loop.to_operator.delay = static_cast<Nanoseconds>(random.index(30)) * kMillisecond;
      }
    }
    EXPECT_GT(seen, 190);
  }
}

TEST(OperatorEnd, FindsTheCarsClockAgainAfterItWasSet) {
  SimulatedLoop loop;
  loop.run(1.0);
  loop.car_clock += kSecond;
  loop.run(1.0);
  const LinkQuality quality = loop.operator_end->quality(loop.now);
  ASSERT_TRUE(quality.clock_offset && quality.command_delay);
  EXPECT_LE(quality.command_delay->highest, 4 * kMillisecond);
  EXPECT_LE(quality.clock_offset->width(), 4 * kMillisecond);
}

TEST(OperatorEnd, KnowsARestartedCarAndLeavesReportsOfTheRunBefore) {
  SimulatedLoop loop;
  loop.run(1.0);
  std::array<std::uint8_t, kLongestFrame> frame;
  const std::size_t size = loop.car->report({}, loop.car_time(), frame);
  loop.start_car();
  loop.run(1.0);
  const std::uint64_t received = loop.operator_end->quality(loop.now).reports_received;
  EXPECT_EQ(loop.operator_end->car_restarts(), 1U);
  EXPECT_EQ(loop.operator_end->quality(loop.now).reports_lost, 0U);
  loop.operator_end->receive(Bytes(frame).first(size), loop.now);
  EXPECT_EQ(loop.operator_end->no_reports(), 1U);
  EXPECT_EQ(loop.operator_end->car_restarts(), 1U);
  EXPECT_EQ(loop.operator_end->quality(loop.now).reports_received, received);
}

TEST(Teleoperation, DrivesOnALineThatFlipsOneByteInAHundred) {
  SimulatedLoop loop(0.01);
  loop.get_going();
  loop.sensors.wheel_speeds.fill(20.0);
  std::uint64_t wrong = 0, compared = 0;
  const double time = veridyn::test::kSanitized ? 10.0 : 100.0;
  loop.run(time, [&] {
    if (loop.now % kMillisecond != 0) return;
    const double t = seconds(loop.now);
    loop.command = {.steering = 0.5 * std::sin(t), .drive_force = 80.0 * std::cos(1.3 * t)};
    const CarCommand& sent = loop.sent.at(loop.car->last_executed().value()).command;
    const CarCommand& executed = loop.actuation.command;
    const bool right = std::abs(executed.steering - sent.steering) <= 0.51e-4 &&
                       std::abs(executed.drive_force - sent.drive_force) <= 0.0251 && executed.brake == sent.brake;
    if (!right) ++wrong;
    ++compared;
  });
  EXPECT_GT(compared, 9'000U);
  EXPECT_EQ(wrong, 0U);
  EXPECT_EQ(loop.car->state(), CarState::kDriving);
  EXPECT_EQ(loop.car->links_lost(), 0U);
  const LinkQuality quality = loop.operator_end->quality(loop.now);
  // A frame is lost with one of its bytes, or with the zero before it: 1 - 0.99^28 and 1 - 0.99^53.
  const double frames = 100.0 * time;
  EXPECT_NEAR(quality.command_loss(), 1.0 - std::pow(0.99, 28), 4.0 * std::sqrt(0.25 / frames));
  EXPECT_NEAR(quality.report_loss(), 1.0 - std::pow(0.99, 53), 4.0 * std::sqrt(0.25 / frames));
  EXPECT_GT(loop.car->frames().damaged(), 0U);
}

/// Faults of every kind at random times. Whatever happens, no command older than `stale_after` is executed, and where
/// nothing was sent for `lost_after` and that long, the car does not drive.
TEST(Teleoperation, NeverDrivesOnOldCommandsWhateverHappens) {
  numerics::RandomStream random(5, "faults");
  const int rounds = 40;
  std::uint64_t lost = 0, executed = 0, times_driven = 0;
  for (int round = 0; round < rounds; ++round) {
    SimulatedLoop loop(round % 2 == 0 ? 0.01 : 0.0, {}, 100 + static_cast<std::uint64_t>(round));
    loop.sensors.wheel_speeds.fill(20.0);
    Nanoseconds last_sent = 0;
    CarState before = CarState::kHolding;
    for (int k = 0; k < 60; ++k) {
      switch (random.index(10)) {
        case 0:
          loop.to_car.cut = !loop.to_car.cut;
          break;
        case 1:
          loop.to_operator.cut = !loop.to_operator.cut;
          break;
        case 2:
          loop.to_car.delay = static_cast<Nanoseconds>(random.index(400)) * kMillisecond;
          break;
        case 3:
          loop.to_operator.delay = static_cast<Nanoseconds>(random.index(400)) * kMillisecond;
          break;
        case 4:
          loop.operator_paused = !loop.operator_paused;
          break;
        case 5:
          loop.car_paused = !loop.car_paused;
          break;
        case 6:
          loop.start_operator();
          break;
        case 7:
          loop.start_car();
          break;
        default:
          loop.to_car.cut = loop.to_operator.cut = loop.operator_paused = loop.car_paused = false;
          loop.to_car.delay = loop.to_operator.delay = 0;
      }
      loop.command = random.index(2) == 0 ? CarCommand{} : CarCommand{.steering = 0.1, .drive_force = 50.0};
      loop.run(random.uniform(0.01, 1.0), [&] {
        if (!loop.operator_paused) last_sent = loop.now;
        if (loop.car_paused || loop.now % kMillisecond != 0) return;
        if (before == CarState::kDriving && loop.actuation.state == CarState::kBraking) ++lost;
        before = loop.actuation.state;
        if (loop.actuation.command.drive_force != 0.0) {
          ++times_driven;
          ASSERT_EQ(loop.actuation.state, CarState::kDriving);
          ASSERT_LE(loop.now - last_sent, 411 * kMillisecond) << round;
        }
      });
    }
    for (const Nanoseconds age : loop.command_ages) ASSERT_LE(age, 200 * kMillisecond) << round;
    executed += loop.command_ages.size();
  }
  // It was not for want of driving.
  EXPECT_GT(lost, static_cast<std::uint64_t>(rounds) * 2);
  EXPECT_GT(executed, static_cast<std::uint64_t>(rounds) * 300);
  EXPECT_GT(times_driven, static_cast<std::uint64_t>(rounds) * 500);
}

}  // namespace
}  // namespace veridyn::live
