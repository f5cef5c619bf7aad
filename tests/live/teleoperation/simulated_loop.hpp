#pragma once

#include <map>
#include <vector>

#include "veridyn/live/teleoperation/car_end.hpp"
#include "veridyn/live/teleoperation/operator_end.hpp"
#include "veridyn/live/virtual/noisy_line.hpp"

namespace veridyn::live::testing {

/// Operator and car with a line between, 100 commands and 100 reports a second, on a clock of its own in steps of 0.1
/// ms. What each end really sent, and when, is kept.
class SimulatedLoop {
 public:
  static constexpr Nanoseconds kStep = kMillisecond / 10;

  struct Sent {
    CarCommand command;
    Nanoseconds at = 0;
  };

  explicit SimulatedLoop(double flipped = 0.0, CarEndOptions options = {}, std::uint64_t seed = 1)
      : to_car(flipped, seed), to_operator(flipped, seed + 1), options_(options) {
    start_operator();
    start_car();
  }

  void start_operator() {
    operator_end.emplace(OperatorEndOptions{.range = options_.range}, ++operator_run_);
    sequence_ = 0;
  }
  void start_car() { car.emplace(options_, static_cast<std::uint16_t>(1000 + ++car_run_)); }

  [[nodiscard]] Nanoseconds car_time() const {
    return now + car_clock + static_cast<Nanoseconds>(car_drift * static_cast<double>(now));
  }

  /// Runs on. `check` is called after each step.
  template <class Check>
  void run(double time, Check check) {
    for (const Nanoseconds end = now + nanoseconds(time); now < end;) {
      now += kStep;
      step();
      check();
    }
  }
  void run(double time) {
    run(time, [] {});
  }

  /// Pedals released until the car drives.
  void get_going() {
    command = {};
    run(0.3);
  }

  NoisyLine to_car, to_operator;
  std::optional<OperatorEnd> operator_end;
  std::optional<CarEnd> car;
  CarActuation actuation;
  CarCommand command;  ///< what the driver wants
  CarSensors sensors;
  Nanoseconds now = 0;
  Nanoseconds car_clock = 1'234'567'891'011;  ///< of the car's clock at the start
  double car_drift = 0.0;                     ///< [s/s]
  bool operator_paused = false, car_paused = false;
  std::map<std::uint32_t, Sent> sent;     ///< by its number; the last one with it
  std::vector<Nanoseconds> command_ages;  ///< true ones, when executed

 private:
  void step() {
    std::array<std::uint8_t, kLongestFrame> frame;
    if (!operator_paused) {
      const std::vector<std::uint8_t> bytes = to_operator.arrived(now);
      operator_end->receive(bytes, now);
      if (now % (10 * kMillisecond) == 0) {
        const std::size_t size = operator_end->command(command, now, frame);
        if (size > 0) sent[sequence_++] = {command, now};
        to_car.send(Bytes(frame).first(size), now);
      }
    }
    if (!car_paused) {
      const std::vector<std::uint8_t> bytes = to_car.arrived(now);
      const std::uint64_t executed = car->verdicts()[CommandVerdict::kExecuted];
      car->receive(bytes, car_time());
      if (car->verdicts()[CommandVerdict::kExecuted] > executed)
        command_ages.push_back(now - sent.at(*car->last_executed()).at);
      if (now % kMillisecond == 0) actuation = car->step(sensors, car_time());
      if (now % (10 * kMillisecond) == 3 * kMillisecond) {
        const std::size_t size = car->report(sensors, car_time(), frame);
        to_operator.send(Bytes(frame).first(size), now);
      }
    }
  }

  CarEndOptions options_;
  std::uint16_t operator_run_ = 0, car_run_ = 0;
  std::uint32_t sequence_ = 0;
};

}  // namespace veridyn::live::testing
