#include "veridyn/recording/stamp_evidence.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::recording {
namespace {

using estimation::Check;
using estimation::Outcome;

/// 1000 samples at 100 Hz, of which the stamp of every so many-th repeats the one before; 0: none.
Recording with_repeated(std::size_t every) {
  std::vector<double> stamps;
  for (std::size_t k = 0; k < 1000; ++k) {
    const bool repeats = every > 0 && k % every == every - 1;
    stamps.push_back(repeats ? stamps.back() : 0.01 * static_cast<double>(k));
  }
  Recording recording;
  recording.source = "test";
  const TimeBase time = make_time_base(stamps);
  for (const char* name : {"yaw_rate", "accel_y"})
    recording.add(make_channel(name, "1", time, std::vector<double>(stamps.size(), 1.0)));
  recording.add(make_channel("speed", "m/s", make_time_base({0.0, 5.0, 9.0}), {1.0, 2.0, 3.0}));
  return recording;
}

const std::vector<SampledChannel> kStamped{{"yaw_rate", "gyro"}, {"accel_y", "accelerometer"}, {"speed", "speed"}};

TEST(StampEvidence, IsARowForEachClockWithRepeatedStamps) {
  const std::vector<TimeSpan> whole{{0.0, 10.0}};
  EXPECT_TRUE(stamp_evidence(with_repeated(0), kStamped, whole).empty());
  const auto rows = stamp_evidence(with_repeated(10), kStamped, whole);
  ASSERT_EQ(rows.size(), 1U) << "the speed has a clock of its own";
  EXPECT_EQ(rows.front().check, Check::kStamps);
  EXPECT_EQ(rows.front().cause, estimation::Cause::kStamps);
  EXPECT_EQ(rows.front().outcome, Outcome::kCare);
  EXPECT_EQ(rows.front().about, "gyro, accelerometer");
  EXPECT_DOUBLE_EQ(rows.front().value, 0.1);
}

TEST(StampEvidence, FailsOfAClockThatIsSlowerThanTheSamples) {
  Recording recording;
  recording.source = "test";
  std::vector<double> stamps;
  for (int k = 0; k < 1000; ++k) stamps.push_back(0.1 * (k / 10));
  recording.add(make_channel("yaw_rate", "rad/s", make_time_base(stamps), std::vector<double>(1000, 1.0)));
  const auto rows = stamp_evidence(recording, kStamped, std::vector<TimeSpan>{{0.0, 100.0}});
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows.front().outcome, Outcome::kFailed);
}

TEST(StampEvidence, CountsInsideTheSpansAlone) {
  EXPECT_TRUE(stamp_evidence(with_repeated(500), kStamped, std::vector<TimeSpan>{{0.0, 4.0}}).empty());
  EXPECT_EQ(stamp_evidence(with_repeated(500), kStamped, std::vector<TimeSpan>{{4.0, 6.0}}).size(), 1U);
}

}  // namespace
}  // namespace veridyn::recording
