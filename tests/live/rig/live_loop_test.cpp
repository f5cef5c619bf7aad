#include "veridyn/live/rig/live_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <thread>

#include "tests/live/rig/car_links_in_memory.hpp"
#include "tests/live/weaving_drive.hpp"
#include "tests/support/counting_new.hpp"
#include "tests/support/sanitized.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/live/rig/live_replay.hpp"
#include "veridyn/live/virtual/virtual_platform.hpp"
#include "veridyn/live/virtual/virtual_vehicle.hpp"

namespace veridyn::live {
namespace {

/// A virtual vehicle and a virtual platform instead of sockets, on a time that is told. Nothing is allocated.
class MemoryLinks final : public LiveLinks {
 public:
  explicit MemoryLinks(const LiveStudy& study, const VirtualVehicleOptions& options = {})
      : platform(study.cueing.platform), vehicle_(test::weaving_drive(100.0), options) {}

  std::optional<Incoming> next(Clock& clock, Nanoseconds until) override {
    if (answered_) {
      answered_ = false;
      return Incoming{LinkOf::kPlatform, {{answer_.data(), answer_.size()}, {1, 3}, clock.now()}};
    }
    while (vehicle_.due() < until) {
      const Nanoseconds due = vehicle_.due();
      const auto packet = vehicle_.next();
      if (!packet) continue;
      clock.sleep_until(due);
      return Incoming{LinkOf::kTelemetry, {*packet, {1, 1}, due}};
    }
    clock.sleep_until(until);
    now = clock.now();
    if (at_step) at_step();
    return std::nullopt;
  }

  bool send(std::string_view order) override {
    platform.step(now);
    const auto answer = platform.take({order, {1, 2}, now});
    if (answer) answer_ = encode(*answer);
    answered_ = answer.has_value();
    return true;
  }

  [[nodiscard]] std::uint64_t sent() const { return vehicle_.sent(); }

  VirtualPlatform platform;
  Nanoseconds now = 0;
  std::function<void()> at_step;

 private:
  VirtualVehicle vehicle_;
  AnswerBytes answer_{};
  bool answered_ = false;
};

class LiveLoopTest : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = std::filesystem::temp_directory_path() /
            fmt::format("veridyn_loop_{}.vlr", ::testing::UnitTest::GetInstance()->current_test_info()->name());
  }
  void TearDown() override { std::filesystem::remove(path_); }

  static LiveHead head_of(const std::string& study) {
    return {.program = "test", .study = study, .study_name = "rig.toml", .started = 0, .started_utc = 0, .session = 5};
  }
  std::filesystem::path path_;
};

const std::string kStudy =
    "[cue]\nalgorithms = ['classical']\n[platform]\nsubject = 'three_axis'\n"
    "[live]\ntelemetry = '127.0.0.1:47123'\nplatform = '127.0.0.1:47124'\nsigns = 'off'\n";

TEST_F(LiveLoopTest, StepsAtItsRateAndSendsWhatTheRigSays) {
  const LiveStudy study = test::rig_study();
  MemoryLinks links(study);
  SetClock clock;
  LiveControl control;
  LiveLoop loop(study, 5);
  control.request(OperatorRequest::kStart);
  loop.run(links, clock, control, nullptr, 10 * kSecond);
  EXPECT_EQ(loop.times().steps, 1000U);
  EXPECT_EQ(loop.times().left_out, 0U);
  EXPECT_EQ(loop.times().not_sent, 0U);
  EXPECT_EQ(links.platform.counts().followed, 1000U);
  EXPECT_EQ(links.platform.counts().outside, 0U);
  const RigStatus& status = control.status();
  EXPECT_EQ(status.step.state, RigState::kRunning);
  const std::uint64_t accepted = status.packets[PacketFate::kAccepted];
  EXPECT_EQ(accepted + status.packets[PacketFate::kUnrecognised], 1000U);
  EXPECT_GT(accepted, 985U);
  EXPECT_EQ(status.times.steps, 1000U);
  // On a time that is told nothing takes any: packets wait for the next deadline, here 10 ms at most.
  EXPECT_LE(status.times.receive_to_send.largest(), 10 * kMillisecond);
  std::vector<Telemetry> motions;
  control.take_motions(motions);
  EXPECT_EQ(motions.size(), accepted);
}

TEST_F(LiveLoopTest, WhatWaitedForTheLoopToBeginIsNotInItsLatency) {
  const LiveStudy study = test::rig_study();
  MemoryLinks links(study);
  SetClock clock(3 * kSecond);  // three seconds of packets are there by then
  LiveControl control;
  LiveLoop loop(study, 5);
  loop.run(links, clock, control, nullptr, 5 * kSecond);
  EXPECT_GT(loop.rig().intake().counts()[PacketFate::kAccepted], 480U);
  EXPECT_LE(loop.times().receive_to_send.count(), 201U);
  EXPECT_GE(loop.times().receive_to_send.count(), 195U);
  EXPECT_LE(loop.times().receive_to_send.largest(), 10 * kMillisecond);
}

/// A run at 200 Hz with packets late and lost and an emergency stop. @param lines of [live]
void expect_no_allocation(const std::string& lines) {
  const LiveStudy study = test::rig_study("rate = '200 Hz'\nsigns = 'off'\n" + lines);
  MemoryLinks links(study, {.jitter = 0.02, .loss = 0.02});
  SetClock clock;
  LiveControl control;
  LiveLoop loop(study, 5);
  control.request(OperatorRequest::kStart);
  long before = 0, first = 0;
  int steps = 0;
  links.at_step = [&] {
    if (++steps == 3) first = allocations;
    if (steps == 2000) control.emergency();
    if (steps == 3000) before = allocations;
  };
  loop.run(links, clock, control, nullptr, 15 * kSecond);
  EXPECT_EQ(steps, 3000);
  EXPECT_EQ(before - first, 0) << lines;
  EXPECT_EQ(loop.rig().state(), RigState::kStopped) << lines;
}

TEST_F(LiveLoopTest, AllocatesNothing) { expect_no_allocation(""); }

TEST_F(LiveLoopTest, AllocatesNothingForPlatformsOfOthers) {
  for (const char* format : {"motion_68", "amc_aasd15a", "flypt"})
    expect_no_allocation(fmt::format("answers = false\nformat = '{}'\n", format));
}

/// A run of the rig at 100 Hz: no packet of ours is lost, nothing is allocated after the first steps, no order is
/// beyond the limits. A drive that is put back to its start costs the packets by which that is noticed.
void expect_a_clean_run(double duration) {
  const LiveStudy study = test::rig_study("packet = 'veridyn'\nrate = '100 Hz'\nsigns = 'off'\n");
  MemoryLinks links(study, {.jitter = 0.008});
  SetClock clock;
  LiveControl control;
  LiveLoop loop(study, 5);
  control.request(OperatorRequest::kStart);
  long first = 0, last = 0;
  std::uint64_t steps = 0;
  links.at_step = [&] {
    if (++steps == 100) first = allocations;
    last = allocations;
  };
  loop.run(links, clock, control, nullptr, nanoseconds(duration));
  EXPECT_EQ(steps, static_cast<std::uint64_t>(std::lround(100.0 * duration)));
  EXPECT_EQ(last - first, 0);
  const PerPacketFate<std::uint64_t> packets = loop.rig().intake().counts();
  std::uint64_t all = 0;
  for (const std::uint64_t count : packets) all += count;
  EXPECT_EQ(all, links.sent());
  const std::uint64_t put_back = loop.rig().intake().drives() - 1;
  EXPECT_EQ(all - packets[PacketFate::kAccepted], put_back * (IntakeOptions().begins_again - 1));
  EXPECT_EQ(loop.times().left_out, 0U);
  EXPECT_EQ(loop.times().not_sent, 0U);
  EXPECT_EQ(links.platform.counts().outside + links.platform.counts().jumps + links.platform.counts().too_hard, 0U);
  EXPECT_EQ(links.platform.counts().followed, steps);
  EXPECT_EQ(loop.rig().state(), RigState::kRunning);
}

TEST_F(LiveLoopTest, RunsAMinuteWithoutALossOrAnAllocation) { expect_a_clean_run(60.0); }

TEST(LiveLoopSoak, RunsAnHourOfToldTimeWithoutALossOrAnAllocation) { expect_a_clean_run(3600.0); }

TEST_F(LiveLoopTest, RecordedRunIsReplayedBitForBitWithItsKnobs) {
  const LiveStudy study = read_live_study(Study::parse(kStudy, "rig.toml"));
  {
    MemoryLinks links(study, {.jitter = 0.02, .loss = 0.03});
    SetClock clock;
    LiveControl control;
    LiveRecorder recorder(path_, head_of(kStudy));
    LiveLoop loop(study, 5);
    control.request(OperatorRequest::kStart);
    int steps = 0;
    links.at_step = [&] {
      ++steps;
      if (steps == 1200 || steps == 1700) {
        auto design = study.cueing.algorithms[0].design->clone();
        auto setting = std::make_unique<KnobSetting>();
        setting->values = knob_values(*design);
        setting->values[0] *= steps == 1200 ? 1.5 : 0.7;
        set_knob_values(*design, setting->values);
        setting->washout = design->make(study.cueing.platform);
        control.turn(std::move(setting));
      }
      if (steps == 2200) control.emergency();
      if (steps == 2300) control.request(OperatorRequest::kRelease);
      control.tidy();
    };
    loop.run(links, clock, control, &recorder, 30 * kSecond);
    EXPECT_EQ(recorder.lost(), 0U);
    EXPECT_EQ(links.platform.counts().outside, 0U);
    EXPECT_EQ(links.platform.counts().jumps + links.platform.counts().too_hard, 0U);
  }
  Progress quiet;
  const LiveFile file = read_live_file(path_);
  const LiveReplay one = replay(file, "run.vlr", quiet), two = replay(file, "run.vlr", quiet);
  EXPECT_EQ(one.times.steps, 3000U);
  EXPECT_EQ(one.different, 0U);
  EXPECT_EQ(one.missing, 0U);
  EXPECT_EQ(one.outside, 0U);
  EXPECT_EQ(one.orders_fingerprint, two.orders_fingerprint);
  ASSERT_EQ(one.turns.size(), 2U);
  EXPECT_NEAR(one.turns[0].time, 12.0, 0.02);
  // Parked, soft start, running, stopped, fade; then parked or still on the way.
  ASSERT_GE(one.changes.size(), 5U);
  EXPECT_EQ(one.changes[1].to, RigState::kSoftStart);
  EXPECT_EQ(one.changes[2].to, RigState::kRunning);
  EXPECT_EQ(one.changes[3].to, RigState::kStopped);
  EXPECT_NEAR(one.changes[3].time, 22.0, 0.011);
  EXPECT_EQ(one.changes[4].to, RigState::kFade);
  EXPECT_EQ(one.layout, "Veridyn motion");
  EXPECT_GT(one.run.steps.size(), 2000U);
  EXPECT_EQ(one.packets[PacketFate::kAccepted], one.times.receive_to_send.count());
}

/// Records a run of `kStudy` that nobody disturbs.
void record_run(const std::filesystem::path& path, const LiveHead& head, Nanoseconds end) {
  const LiveStudy study = read_live_study(Study::parse(kStudy, "rig.toml"));
  MemoryLinks links(study);
  SetClock clock;
  LiveControl control;
  LiveRecorder recorder(path, head);
  LiveLoop loop(study, 5);
  control.request(OperatorRequest::kStart);
  loop.run(links, clock, control, &recorder, end);
}

TEST_F(LiveLoopTest, AReplayWithOtherNumbersIsSaidToDiffer) {
  record_run(path_, head_of(kStudy), 6 * kSecond);
  LiveFile file = read_live_file(path_);
  Progress quiet;
  ASSERT_EQ(replay(file, "run.vlr", quiet).different, 0U);
  // Another gain in the study than the run had.
  file.head.study += "[washout.classical]\nforce_gain = [0.1, 0.1, 0.1]\n";
  EXPECT_GT(replay(file, "run.vlr", quiet).different, 100U);
}

TEST_F(LiveLoopTest, TheRecordingOfARunThatWasCutOffIsReplayedAsFarAsItGoes) {
  record_run(path_, head_of(kStudy), 20 * kSecond);
  std::string bytes = read_file(path_);
  bytes.resize(bytes.size() / 2);
  Progress quiet;
  const LiveReplay r = replay(parse_live_file(bytes, "run.vlr"), "run.vlr", quiet);
  EXPECT_GT(r.times.steps, 500U);
  EXPECT_LT(r.times.steps, 1500U);
  EXPECT_EQ(r.different, 0U);
  EXPECT_GT(r.cut_bytes, 0U);
}

TEST_F(LiveLoopTest, AllocatesNothingWithACarEither) {
  {
    test::CarRun r(0.01);
    LiveRecorder recorder(path_, {.program = "test",
                                  .study = test::kCarStudy,
                                  .study_name = "rig.toml",
                                  .started = 0,
                                  .started_utc = 0,
                                  .session = 5});
    r.run(6.0, &recorder);
  }
  test::PlayedLinks links(read_live_file(path_));
  const LiveStudy study = test::car_study();
  SetClock clock;
  LiveControl control;
  LiveLoop loop(study, 5);
  control.request(OperatorRequest::kStart);
  long first = 0, last = 0;
  int steps = 0;
  links.at_step = [&] {
    ++steps;
    if (steps == 3) first = allocations;
    if (steps == 500) control.emergency();
    if (steps == 590) last = allocations;
  };
  loop.run(links, clock, control, nullptr, 6 * kSecond);
  EXPECT_GT(loop.times().commands, 500U);
  EXPECT_GT(loop.rig().car()->quality(clock.now()).reports_received, 200U);
  if (!veridyn::test::kSanitized) {
    EXPECT_EQ(last - first, 0);
  }
}

}  // namespace
}  // namespace veridyn::live
