#include "veridyn/live/rig/recorded_rig.hpp"

#include <gtest/gtest.h>

#include "tests/live/rig/recorded_run.hpp"

namespace veridyn::live {
namespace {

using test::LiveLoopTest;

TEST_F(LiveLoopTest, RecordedRigShowsTheStatusThatTheLoopShowed) {
  RigStatus then;
  test::record_run(path_, head_of(test::kRecordedStudy), 8 * kSecond, [&](const RigStatus& s) { then = s; });
  const LiveFile file = read_live_file(path_);
  RecordedRig rig(recorded_study(file.head), file.head);
  std::size_t steps = 0, telemetry = 0;
  for (const std::string_view block : file.blocks) {
    EXPECT_TRUE(for_each_record(block, [&](const LiveRecord& r) {
      const RecordedRig::Taken taken = rig.take(r);
      steps += taken.step != nullptr ? 1U : 0U;
      telemetry += taken.telemetry ? 1U : 0U;
      EXPECT_EQ(taken.step != nullptr, r.kind == LiveRecord::Kind::kStep);
    }));
  }
  const RigStatus now = rig.status();
  EXPECT_EQ(steps, then.times.steps);
  EXPECT_EQ(telemetry, then.packets[PacketStatus::kAccepted]);
  EXPECT_EQ(now.step.time, then.step.time);
  EXPECT_EQ(now.step.state, RigState::kRunning);
  EXPECT_EQ(now.step.order, then.step.order);
  EXPECT_EQ(now.readiness, then.readiness);
  EXPECT_EQ(now.answers.count, then.answers.count);
  EXPECT_EQ(now.answers.reached, then.answers.reached);
  EXPECT_EQ(now.packets, then.packets);
  EXPECT_EQ(now.extrapolated.of, then.extrapolated.of);
  EXPECT_EQ(now.times.steps, then.times.steps);
  EXPECT_EQ(now.times.left_out, then.times.left_out);
  EXPECT_EQ(now.times.receive_to_send.count(), then.times.receive_to_send.count());
  EXPECT_EQ(now.times.receive_to_send.quantile(0.5), then.times.receive_to_send.quantile(0.5));
  EXPECT_EQ(now.times.work.count(), 0U);
}

}  // namespace
}  // namespace veridyn::live
