#include "veridyn/live/rig/live_replay.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "tests/live/rig/car_links_in_memory.hpp"
#include "tests/live/rig/links_in_memory.hpp"
#include "tests/live/rig/recorded_run.hpp"
#include "tests/live/time/set_clock.hpp"
#include "tests/support/temporary_folder.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/live/recording/live_recorder.hpp"

namespace veridyn::live {
namespace {

using test::CarRun;
using test::LiveLoopTest;
using test::MemoryLinks;

const std::string& kStudy = test::kRecordedStudy;

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
  EXPECT_EQ(one.packets[PacketStatus::kAccepted], one.times.receive_to_send.count());
}

TEST_F(LiveLoopTest, AReplayWithOtherNumbersIsSaidToDiffer) {
  test::record_run(path_, head_of(kStudy), 6 * kSecond);
  LiveFile file = read_live_file(path_);
  Progress quiet;
  ASSERT_EQ(replay(file, "run.vlr", quiet).different, 0U);
  // Another gain in the study than the run had.
  file.head.study += "[washout.classical]\nforce_gain = [0.1, 0.1, 0.1]\n";
  EXPECT_GT(replay(file, "run.vlr", quiet).different, 100U);
}

TEST_F(LiveLoopTest, TheRecordingOfARunThatWasCutOffIsReplayedAsFarAsItGoes) {
  test::record_run(path_, head_of(kStudy), 20 * kSecond);
  std::string bytes = read_file(path_);
  bytes.resize(bytes.size() / 2);
  Progress quiet;
  const LiveReplay r = replay(parse_live_file(bytes, "run.vlr"), "run.vlr", quiet);
  EXPECT_GT(r.times.steps, 500U);
  EXPECT_LT(r.times.steps, 1500U);
  EXPECT_EQ(r.different, 0U);
  EXPECT_GT(r.cut_bytes, 0U);
}

TEST(CarLink, IsReplayedBitForBitWithItsCommands) {
  const veridyn::test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "car.vlr";
  {
    CarRun r(0.01);
    LiveRecorder recorder(path, {.program = "test",
                                 .study = test::kCarStudy,
                                 .study_name = "rig.toml",
                                 .started = 0,
                                 .started_utc = 0,
                                 .session = 5});
    r.run(4.0, &recorder);
    r.control.emergency();
    r.run(1.0, &recorder);
  }
  Progress progress;
  const LiveReplay replayed = replay(read_live_file(path), path.string(), progress);
  EXPECT_EQ(replayed.times.steps, 500U);
  EXPECT_EQ(replayed.different, 0U);
  ASSERT_TRUE(replayed.car);
  EXPECT_EQ(replayed.car->commands, 500U);
  EXPECT_EQ(replayed.car->commands_different, 0U);
  EXPECT_GT(replayed.car->drive.rows(), 200U);
  EXPECT_GT(replayed.times.pedal_to_command.count(), 400U);
  // From pedal to platform: the stages, each measured, add up to the whole.
  const PedalTrace::Result& way = replayed.car->pedal_to_platform;
  EXPECT_GT(way.whole.count(), 50U);
  double sum = 0.0;
  for (const LatencyHistogram& stage : way.stages) {
    EXPECT_EQ(stage.count(), way.whole.count());
    sum += stage.mean();
  }
  EXPECT_NEAR(sum, way.whole.mean(), 1e-9);
  // The study's delay of 20 ms is in it, and the bits of both frames at 250 kbit/s: 3.16 ms.
  EXPECT_GT(way[PedalTrace::Stage::kMotion].mean(), 0.018);
  EXPECT_GT(way[PedalTrace::Stage::kLine].mean(), 3.0e-3);
  EXPECT_LT(way.whole.mean(), 0.06);
}

TEST(CarLink, ReplayFindsACommandThatDiffers) {
  const veridyn::test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "car.vlr";
  {
    CarRun r;
    LiveRecorder recorder(path, {.program = "test",
                                 .study = test::kCarStudy,
                                 .study_name = "rig.toml",
                                 .started = 0,
                                 .started_utc = 0,
                                 .session = 6});
    r.run(1.0, &recorder);  // as session 5
  }
  Progress progress;
  const LiveReplay replayed = replay(read_live_file(path), path.string(), progress);
  EXPECT_EQ(replayed.car->commands_different, replayed.car->commands);
}

}  // namespace
}  // namespace veridyn::live
