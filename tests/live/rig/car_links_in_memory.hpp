#pragma once

#include <cmath>
#include <deque>
#include <functional>
#include <memory>
#include <string>

#include "tests/live/time/set_clock.hpp"
#include "tests/live/virtual/one_to_five.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/live/driver/driver_source.hpp"
#include "veridyn/live/driver/driver_table.hpp"
#include "veridyn/live/link/live_links.hpp"
#include "veridyn/live/recording/live_file.hpp"
#include "veridyn/live/rig/live_loop.hpp"
#include "veridyn/live/virtual/noisy_line.hpp"
#include "veridyn/live/virtual/virtual_car.hpp"
#include "veridyn/live/virtual/virtual_platform.hpp"

namespace veridyn::live::test {

inline const std::string kCarStudy =
    "[cue]\nalgorithms = ['classical']\n[platform]\nsubject = 'three_axis'\n"
    "[live]\ntelemetry = 'car'\nplatform = '127.0.0.1:47124'\nsigns = 'off'\nsoft_start = 1\n"
    "[live.car]\nsteering = '0.5 rad'\nforce = '30 N'\n[live.driver]\ntable = 'drive.csv'\nratio = 10\n";

/// A rig whose telemetry is a car's.
inline LiveStudy car_study(const std::string& text = kCarStudy) {
  const Study study = Study::parse(text, "rig.toml");
  LiveStudy s = read_live_study(study);
  study.root().finish();
  return s;
}

/// What a driver does: pedals released for half a second, then a weave under a little throttle.
inline std::vector<WheelEvent> weaving_driver(double duration) {
  std::vector<WheelEvent> events;
  const WheelCalibration wheel = table_calibration();
  for (int k = 0; k <= static_cast<int>(100.0 * duration); ++k) {
    const Nanoseconds at = k * kSecond / 100;
    const double t = seconds(at);
    const auto add = [&](std::uint16_t type, std::uint16_t code, double value) {
      events.push_back({.time = at, .type = type, .code = code, .value = static_cast<std::int32_t>(value)});
    };
    add(kAxisEvent, wheel.steering.axis, t < 0.5 ? 0.0 : 1e5 * std::sin(2.0 * t));
    add(kAxisEvent, wheel.throttle.axis, t < 0.5 ? 0.0 : t < 2.5 ? 4e4 : 5e3);
    add(kAxisEvent, wheel.brake.axis, 0.0);
    add(kSyncEvent, kSyncReport, 0.0);
  }
  return events;
}

/// Car, line, driver and platform instead of devices and sockets, on a time that is given.
class CarLinksInMemory final : public LiveLinks {
 public:
  CarLinksInMemory(const LiveStudy& study, std::vector<WheelEvent> driver, double flips = 0.0)
      : platform(study.cueing.platform),
        car(test::one_to_five(), virtual_car_options(*study.car, 3), 77),
        to_car(flips, 5),
        to_rig(flips, 6),
        driver_(recorded_source(std::move(driver), study.driver->calibration.at_rest())) {}

  std::optional<Incoming> next(Clock& clock, Nanoseconds until) override {
    constexpr Nanoseconds kTick = kMillisecond;
    while (true) {
      const Nanoseconds now = clock.now();
      if (!bytes_.empty()) {
        held_ = std::move(bytes_.front());
        bytes_.pop_front();
        return Incoming{held_.link, {{held_.bytes.data(), held_.bytes.size()}, {}, now}};
      }
      if (now + kTick > until) {
        clock.sleep_until(until);
        return std::nullopt;
      }
      clock.sleep_until(now + kTick);
      tick(now + kTick);
    }
  }

  bool send(std::string_view order) override {
    if (!platform_there) return true;
    platform.step(now_);
    if (const auto answer = platform.take({order, {1, 2}, now_})) {
      const AnswerBytes bytes = encode(*answer);
      bytes_.push_back({LinkOf::kPlatform, std::string(bytes.data(), bytes.size())});
    }
    return true;
  }
  bool send_command(std::string_view command) override {
    to_car.send({reinterpret_cast<const std::uint8_t*>(command.data()), command.size()}, now_);
    return true;
  }

  VirtualPlatform platform;
  VirtualCar car;
  NoisyLine to_car, to_rig;
  bool platform_there = true;
  std::function<void(Nanoseconds)> at_tick;

 private:
  struct Held {
    LinkOf link = LinkOf::kCar;
    std::string bytes;
  };

  void tick(Nanoseconds now) {
    now_ = now;
    if (at_tick) at_tick(now);
    car.advance(now + kItsZero);
    car.receive(to_car.arrived(now), now + kItsZero);
    if (now % (10 * kMillisecond) == 4 * kMillisecond) {
      std::array<std::uint8_t, kLongestFrame> frame{};
      to_rig.send(Bytes(frame).first(car.report(now + kItsZero, frame)), now);
    }
    const std::vector<std::uint8_t> arrived = to_rig.arrived(now);
    if (!arrived.empty()) bytes_.push_back({LinkOf::kCar, std::string(arrived.begin(), arrived.end())});
    if (driver_gone_) return;
    std::array<std::uint8_t, 40 * WheelEventDecoder::kRecord> records{};
    const std::size_t size = driver_->read(now, records);
    driver_gone_ = size == 0 && driver_->ended();
    if (size > 0 || driver_gone_)
      bytes_.push_back({LinkOf::kDriver, std::string(records.begin(), records.begin() + size)});
  }

  static constexpr Nanoseconds kItsZero = 1234 * kSecond;  // its clock is not ours
  std::unique_ptr<DriverSource> driver_;
  std::deque<Held> bytes_;
  Held held_;
  bool driver_gone_ = false;
  Nanoseconds now_ = 0;
};

/// A loop with all of that.
struct CarRun {
  explicit CarRun(double flips = 0.0, double driven = 100.0)
      : study(test::car_study()), links(study, test::weaving_driver(driven), flips), loop(study, 5) {
    control.request(OperatorRequest::kStart);
  }
  void run(double time, LiveRecorder* recorder = nullptr) {
    end += nanoseconds(time);
    loop.run(links, clock, control, recorder, end);
  }
  LiveStudy study;
  CarLinksInMemory links;
  SetClock clock;
  LiveControl control;
  LiveLoop loop;
  Nanoseconds end = 0;
};

/// Plays what came in before, and nothing else.
class PlayedLinks final : public LiveLinks {
 public:
  explicit PlayedLinks(const LiveFile& file) {
    for (const std::string_view block : file.blocks) {
      for_each_record(block, [&](const LiveRecord& r) {
        if (r.kind == LiveRecord::Kind::kDatagram) played_.push_back({r, std::string(r.datagram.bytes)});
      });
    }
  }
  std::optional<Incoming> next(Clock& clock, Nanoseconds until) override {
    if (at_ < played_.size() && played_[at_].record.time < until) {
      const Played& p = played_[at_++];
      clock.sleep_until(p.record.time);
      return Incoming{p.record.link, {p.bytes, {}, p.record.datagram.arrival}};
    }
    clock.sleep_until(until);
    if (at_step) at_step();
    return std::nullopt;
  }
  bool send(std::string_view /*order*/) override { return true; }
  bool send_command(std::string_view /*command*/) override { return true; }
  std::function<void()> at_step;

 private:
  struct Played {
    LiveRecord record;
    std::string bytes;
  };
  std::vector<Played> played_;
  std::size_t at_ = 0;
};

}  // namespace veridyn::live::test
