#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

#include "tests/live/teleoperation/simulated_loop.hpp"
#include "veridyn/live/serial/pseudo_terminal.hpp"
#include "veridyn/live/serial/serial_line.hpp"

namespace veridyn::live {
namespace {

/// What the driver asks for at the command of that number; pedals are released at first and every ten seconds.
CarCommand command_of(std::uint32_t sequence) {
  if (sequence % 1000 < 50) return {};
  return {.steering = 0.5 * std::sin(0.01 * sequence), .drive_force = 80.0 * std::cos(0.013 * sequence)};
}

struct PseudoTerminalRun {
  std::vector<Nanoseconds> command_delays;  ///< from sending to execution, both on one clock
  std::uint64_t wrong = 0;                  ///< executed other than sent
  std::uint64_t links_lost = 0;
  LinkQuality quality;
  std::uint64_t damaged_at_car = 0;
};

/// A line of 250 kbit/s between two pseudo-terminals that flips bytes, until it is stopped.
void pass_bytes(PseudoTerminal& at_operator, PseudoTerminal& at_car, double flipped, const std::atomic<bool>& stop) {
  RealClock own;
  NoisyLine to_car(flipped, 1), to_operator(flipped, 2);
  std::array<std::uint8_t, 4096> from_operator, from_car;
  while (!stop) {
    // The time after reading: no byte is older than it says, however long this thread had to wait.
    const Bytes out = Bytes(from_operator).first(at_operator.read_some(from_operator));
    const Bytes back = Bytes(from_car).first(at_car.read_some(from_car));
    const Nanoseconds now = own.now();
    to_car.send(out, now);
    to_operator.send(back, now);
    at_car.write(to_car.arrived(now));
    at_operator.write(to_operator.arrived(now));
    own.sleep_until(now + 100'000);
  }
}

/// Both ends in threads of their own, each on a serial line of its own, and between these a line of 250 kbit/s that
/// flips bytes: 100 commands and 100 reports a second.
PseudoTerminalRun run_on_pseudo_terminals(double time, double flipped) {
  PseudoTerminal at_operator, at_car;
  const auto commands = static_cast<std::size_t>(time * 100.0) + 100;
  std::vector<std::atomic<Nanoseconds>> sent_at(commands);
  std::atomic<bool> stop = false;
  PseudoTerminalRun run;
  RealClock clock;
  const Nanoseconds start = clock.now();

  std::thread line([&] { pass_bytes(at_operator, at_car, flipped, stop); });
  std::thread car_thread([&] {
    RealClock own;
    SerialLine serial({.device = at_car.device()});
    CarEnd car({}, 7);
    CarSensors sensors;
    sensors.wheel_speeds.fill(20.0);
    std::array<std::uint8_t, 4096> chunk;
    std::array<std::uint8_t, kLongestFrame> frame;
    std::optional<std::uint32_t> last;
    Nanoseconds next_report = start;
    run.command_delays.reserve(commands);
    while (!stop) {
      serial.wait(kMillisecond);
      const Bytes bytes = Bytes(chunk).first(serial.read(chunk));
      const Nanoseconds now = own.now();
      car.receive(bytes, now);
      const CarActuation actuation = car.step(sensors, now);
      if (car.last_executed() && car.last_executed() != last) {
        last = car.last_executed();
        run.command_delays.push_back(now - sent_at.at(*last).load());
        const CarCommand sent = command_of(*last);
        const bool right = std::abs(actuation.command.steering - sent.steering) <= 0.51e-4 &&
                           std::abs(actuation.command.drive_force - sent.drive_force) <= 0.0251;
        if (actuation.state == CarState::kDriving && !right) ++run.wrong;
      }
      if (now >= next_report) {
        serial.write(Bytes(frame).first(car.report(sensors, now, frame)));
        next_report += 10 * kMillisecond;
      }
    }
    run.links_lost = car.links_lost();
    run.damaged_at_car = car.frames().damaged();
  });
  {
    SerialLine serial({.device = at_operator.device()});
    OperatorEnd driver({}, 9);
    std::array<std::uint8_t, 4096> chunk;
    std::array<std::uint8_t, kLongestFrame> frame;
    std::uint32_t sequence = 0;
    for (Nanoseconds next = start; next < start + nanoseconds(time);) {
      serial.wait(kMillisecond);
      driver.receive(Bytes(chunk).first(serial.read(chunk)), clock.now());
      const Nanoseconds now = clock.now();
      if (now < next) continue;
      sent_at.at(sequence) = now;
      serial.write(Bytes(frame).first(driver.command(command_of(sequence), now, frame)));
      ++sequence;
      next += 10 * kMillisecond;
    }
    run.quality = driver.quality(clock.now());
    stop = true;
    line.join();
    car_thread.join();
  }
  std::sort(run.command_delays.begin(), run.command_delays.end());
  return run;
}

void print(const PseudoTerminalRun& run) {
  const auto quantile = [&](double q) {
    return 1e-6 *
           static_cast<double>(
               run.command_delays[static_cast<std::size_t>(q * static_cast<double>(run.command_delays.size() - 1))]);
  };
  fmt::print(
      "{} commands executed, {} wrong; command p50 {:.2f} ms, p99 {:.2f} ms, longest {:.2f} ms; round trip p50 "
      "{:.2f} ms, p99 {:.2f} ms; lost {:.1f} % of commands, {:.1f} % of reports\n",
      run.command_delays.size(), run.wrong, quantile(0.5), quantile(0.99), quantile(1.0),
      1e-6 * static_cast<double>(*run.quality.round_trip_median),
      1e-6 * static_cast<double>(*run.quality.round_trip_p99), 100.0 * run.quality.command_loss(),
      100.0 * run.quality.report_loss());
}

/// How long most commands take depends on what else the machine does; what holds whatever it does is asserted.
void expect_a_drive(const PseudoTerminalRun& run, double time) {
  EXPECT_EQ(run.wrong, 0U);
  EXPECT_GT(run.damaged_at_car, 0U);
  // 0.99^28 of the commands are whole, 0.99^53 of the reports. On a machine that is too busy some are stale.
  EXPECT_NEAR(run.quality.command_loss(), 1.0 - std::pow(0.99, 28), 4.0 * std::sqrt(0.25 / (100.0 * time)));
  EXPECT_NEAR(run.quality.report_loss(), 1.0 - std::pow(0.99, 53), 4.0 * std::sqrt(0.25 / (100.0 * time)));
  ASSERT_GT(run.command_delays.size(), static_cast<std::size_t>(10.0 * time));
  EXPECT_LE(run.command_delays.back(), 200 * kMillisecond);
  ASSERT_TRUE(run.quality.round_trip_median && run.quality.command_delay && run.quality.report_delay);
  // No faster than the bits: 27 and 52 bytes of 40 us.
  EXPECT_GE(run.command_delays.front(), 27 * 40'000);
  EXPECT_GE(*run.quality.round_trip_least, 79 * 40'000);
  // Both ends have the same clock here: its offset of none is within the bounds, modulo the stamps' 2^32 us.
  const Nanoseconds wrap = (Nanoseconds{1} << 32U) * 1000;
  const Nanoseconds truth = -(RealClock().now() / wrap * wrap);
  EXPECT_LE(run.quality.clock_offset->lowest, truth);
  EXPECT_GE(run.quality.clock_offset->highest, truth);
}

TEST(TeleoperationOnPseudoTerminals, ExecutesNothingThatWasNotSent) {
  const PseudoTerminalRun run = run_on_pseudo_terminals(3.0, 0.01);
  print(run);
  expect_a_drive(run, 3.0);
}

TEST(TeleoperationOnPseudoTerminalsSoak, ExecutesNothingThatWasNotSentInTwoMinutes) {
  const PseudoTerminalRun run = run_on_pseudo_terminals(120.0, 0.01);
  print(run);
  expect_a_drive(run, 120.0);
}

}  // namespace
}  // namespace veridyn::live
