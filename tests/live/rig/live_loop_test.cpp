#include "veridyn/live/rig/live_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/live/rig/car_links_in_memory.hpp"
#include "tests/live/rig/links_in_memory.hpp"
#include "tests/live/time/set_clock.hpp"
#include "tests/live/weaving_drive.hpp"
#include "tests/support/counting_new.hpp"
#include "tests/support/sanitized.hpp"

namespace veridyn::live {
namespace {

using test::LiveLoopTest;
using test::MemoryLinks;

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
  const std::uint64_t accepted = status.packets[PacketStatus::kAccepted];
  EXPECT_EQ(accepted + status.packets[PacketStatus::kUnrecognised], 1000U);
  EXPECT_GT(accepted, 985U);
  EXPECT_EQ(status.times.steps, 1000U);
  // On a time that is given nothing takes any: packets wait for the next deadline, here 10 ms at most.
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
  EXPECT_GT(loop.rig().intake().counts()[PacketStatus::kAccepted], 480U);
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
  const PerPacketStatus<std::uint64_t> packets = loop.rig().intake().counts();
  std::uint64_t all = 0;
  for (const std::uint64_t count : packets) all += count;
  EXPECT_EQ(all, links.sent());
  const std::uint64_t put_back = loop.rig().intake().drives() - 1;
  EXPECT_EQ(all - packets[PacketStatus::kAccepted], put_back * (IntakeOptions().begins_again - 1));
  EXPECT_EQ(loop.times().left_out, 0U);
  EXPECT_EQ(loop.times().not_sent, 0U);
  EXPECT_EQ(links.platform.counts().outside + links.platform.counts().jumps + links.platform.counts().too_hard, 0U);
  EXPECT_EQ(links.platform.counts().followed, steps);
  EXPECT_EQ(loop.rig().state(), RigState::kRunning);
}

TEST_F(LiveLoopTest, RunsAMinuteWithoutALossOrAnAllocation) { expect_a_clean_run(60.0); }

TEST(LiveLoopSoak, RunsAnHourOfToldTimeWithoutALossOrAnAllocation) { expect_a_clean_run(3600.0); }

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
