#include "veridyn/live/rig/running_loop.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>

#include "tests/live/weaving_drive.hpp"

namespace veridyn::live {
namespace {

/// A vehicle at real time; the platform does not answer. What was sent last is kept.
class VehicleLinks final : public LiveLinks {
 public:
  VehicleLinks() : vehicle_(test::weaving_drive(30.0), {}) {}

  std::optional<Incoming> next(Clock& clock, Nanoseconds until) override {
    if (start_ == 0) start_ = clock.now();
    const Nanoseconds due = start_ + vehicle_.due();
    if (due >= until) {
      clock.sleep_until(until);
      return std::nullopt;
    }
    clock.sleep_until(due);
    const auto packet = vehicle_.next();
    if (!packet) return std::nullopt;
    return Incoming{LinkOf::kTelemetry, {*packet, {1, 1}, due}};
  }
  bool send(std::string_view order) override {
    last = decode_order(order)->state;
    moved = moved || last != RigState::kParked;
    return true;
  }

  RigState last = RigState::kParked;
  bool moved = false;

 private:
  VirtualVehicle vehicle_;
  Nanoseconds start_ = 0;
};

LiveStudy quick_study() { return test::rig_study("signs = 'off'\nanswers = false\nsoft_start = 0.5\nfade = 0.5\n"); }

TEST(RunningLoop, ParksThePlatformWhereItsOperatorsSideThrows) {
  const LiveStudy study = quick_study();
  VehicleLinks links;
  LiveLoop loop(study, 5);
  LiveControl control;
  RealClock clock;
  control.request(OperatorRequest::kStart);
  try {
    RunningLoop running(control, 20.0, [&] { loop.run(links, clock, control, nullptr, std::nullopt); });
    const Nanoseconds give_up = clock.now() + 20 * kSecond;
    while (control.status().step.state != RigState::kRunning && clock.now() < give_up)
      clock.sleep_until(clock.now() + 10 * kMillisecond);
    ASSERT_EQ(control.status().step.state, RigState::kRunning);
    throw std::runtime_error("the operator's side fails");
  } catch (const std::runtime_error&) {
  }
  EXPECT_TRUE(links.moved);
  EXPECT_EQ(links.last, RigState::kParked);
  EXPECT_TRUE(control.ended());
}

TEST(RunningLoop, EndsAtOnceWhereItIsTold) {
  const LiveStudy study = quick_study();
  VehicleLinks links;
  LiveLoop loop(study, 5);
  LiveControl control;
  RealClock clock;
  RunningLoop running(control, 20.0, [&] { loop.run(links, clock, control, nullptr, std::nullopt); });
  running.end();
  EXPECT_TRUE(control.ended());
}

}  // namespace
}  // namespace veridyn::live
