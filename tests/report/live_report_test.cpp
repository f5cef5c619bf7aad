#include "veridyn/report/live_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/live/weaving_drive.hpp"
#include "veridyn/report/document/json.hpp"

namespace veridyn::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

live::LiveReplay some_run() {
  live::LiveReplay r;
  r.study = live::test::rig_study();
  r.run.algorithm = "classical";
  r.times.steps = 1000;
  r.duration = 10.0;
  r.orders_fingerprint = "0123abcd";
  r.changes = {{0.0, live::RigState::kParked, live::Readiness::kNoTelemetry},
               {1.5, live::RigState::kSoftStart, live::Readiness::kReady}};
  r.drift = 20e-6;
  r.extrapolated = {.steps = 7, .of = 900, .longest = 0.012};
  for (int k = 0; k < 100; ++k) r.times.receive_to_send.add(300'000);
  return r;
}

/// What the page holds: its HTML writes apostrophes in one way with the front end, in another without it.
std::string page_of(const live::LiveReplay& run, const std::vector<std::string>& notes = {}) {
  return to_json(live_report(run, {}, notes, "veridyn 1.0"));
}

TEST(LiveReport, SaysThatARunWasWithinItsLimitsAndIsTheSameAgain) {
  const std::string page = page_of(some_run(), {"a note of the run"});
  EXPECT_THAT(page, HasSubstr("1000 orders in 10.0 s, all within the platform's limits, and the same when replayed"));
  EXPECT_THAT(page, HasSubstr("a note of the run"));
  EXPECT_THAT(page, HasSubstr("soft start"));
  EXPECT_THAT(page, HasSubstr("fingerprint 0123abcd"));
  EXPECT_THAT(page, HasSubstr("7 of 900, by 12 ms at most"));
  EXPECT_THAT(page, Not(HasSubstr("ppm fast")));
}

TEST(LiveReport, ShowsTheShareOfEachStageWhereItWasMeasured) {
  live::LiveReplay run = some_run();
  EXPECT_THAT(page_of(run), Not(HasSubstr("waiting for the next order")));
  run.times.wait.add(250'000);
  run.times.work.add(50'000);
  EXPECT_THAT(page_of(run), HasSubstr("waiting for the next order"));
  EXPECT_THAT(page_of(run), HasSubstr("from the step's beginning to the order sent"));
}

TEST(LiveReport, NamesWhatIsWrong) {
  live::LiveReplay run = some_run();
  run.outside = 3;
  run.different = 5;
  run.missing = 2;
  const std::string page = page_of(run);
  EXPECT_THAT(page, HasSubstr("3 orders were beyond the platform's limits"));
  EXPECT_THAT(page, HasSubstr("5 of 1000 orders differ when the recording is replayed: 2 steps are missing in it"));
}

TEST(LiveReport, CautionsOfAPoorClockMissedDeadlinesAndADamagedRecording) {
  live::LiveReplay run = some_run();
  run.drift = -300e-6;
  run.times.left_out = 50;
  run.damaged = 1;
  run.cut_bytes = 17;
  const std::string page = page_of(run);
  EXPECT_THAT(page, HasSubstr("the sender's clock runs 300 ppm fast against ours"));
  EXPECT_THAT(page, HasSubstr("50 of 1050 deadlines were missed"));
  EXPECT_THAT(page, HasSubstr("damaged in 1 places and cut by 17 bytes"));
}

}  // namespace
}  // namespace veridyn::report
