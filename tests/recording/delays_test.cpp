#include "veridyn/recording/delays.hpp"

#include <optional>
#include <utility>
#include <vector>

#include "tests/io/support.hpp"
#include "tests/recording/lively_signal.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::recording {
namespace {

using ::testing::HasSubstr;
using testing::kLivelyRate_Hz;
using testing::later;
using testing::lively;
using testing::message_of;

Channel channel(const char* name, double rate, double seconds, double value = 0.0) {
  std::vector<double> stamps, values;
  for (std::size_t k = 0; static_cast<double>(k) <= rate * seconds; ++k) {
    stamps.push_back(static_cast<double>(k) / rate);
    values.push_back(value);
  }
  return make_channel(name, "rad/s", make_time_base(std::move(stamps)), std::move(values));
}

TEST(Delays, PairsShareTheDelayThatBothWereGiven) {
  const std::vector<double> a = lively(3000, "a"), b = lively(3000, "b");
  const DelayReport report =
      shared_delay("gps", "accelerometer", {{a, later(a, 7)}, {b, later(b, 7)}}, kLivelyRate_Hz, {});
  EXPECT_NEAR(report.delay_s, 0.07, 0.003);
  EXPECT_TRUE(report.applied());
  EXPECT_EQ(says(report), "applied");
}

TEST(Delays, SmallOnesAreLeftAloneAndAnOppositeSignIsNamed) {
  const std::vector<double> a = lively(3000, "a");
  const DelayReport small = shared_delay("gps", "accelerometer", {{a, a}}, kLivelyRate_Hz, {});
  EXPECT_FALSE(small.applied());
  EXPECT_EQ(small.finding, DelayFinding::kSmall);
  std::vector<double> turned = later(a, 5);
  for (double& v : turned) v = -v;
  const DelayReport opposite = shared_delay("gps", "accelerometer", {{a, turned}}, kLivelyRate_Hz, {});
  EXPECT_FALSE(opposite.applied());
  EXPECT_EQ(opposite.finding, DelayFinding::kOppositeSign);
  // What has little to do with each other has no sign.
  const std::vector<double> b = lively(3000, "b");
  for (std::size_t k = 0; k < turned.size(); ++k) turned[k] = b[k] - 0.3 * a[k];
  const DelayReport unrelated = shared_delay("gps", "accelerometer", {{a, turned}}, kLivelyRate_Hz, {});
  EXPECT_LT(unrelated.correlation, -0.1);
  EXPECT_EQ(unrelated.finding, DelayFinding::kNoPeak);
}

// An aircraft answers the gust that its vane shows, against it and late: correlation finds a delay where there is none.
TEST(Delays, ADisturbanceThatIsAnsweredIsInTheError) {
  double earlier = 0.0;
  for (const double gust : {0.0, 0.3, 0.6, 1.0}) {
    const std::vector<double> motion = lively(20000, "motion"), air = lively(20000, "gust");
    std::vector<double> expected(motion.size()), observed(motion.size());
    double answer = 0.0;
    for (std::size_t k = 0; k < motion.size(); ++k) {
      answer += 0.1 * (-air[k] - answer);
      expected[k] = motion[k] + gust * answer;
      observed[k] = expected[k] + gust * air[k];
    }
    const DelayReport as_noise = shared_delay("vane", "motion", {{expected, observed}}, kLivelyRate_Hz, {});
    const DelayReport answered = shared_delay(
        "vane", "motion", {{.expected = expected, .observed = observed, .noise_variance = 0.0}}, kLivelyRate_Hz, {});
    EXPECT_EQ(answered.delay_s, as_noise.delay_s);
    EXPECT_LE(std::abs(answered.delay_s), 1e-6 + 1.96 * answered.sigma_s) << gust;
    EXPECT_FALSE(answered.applied()) << gust << ": " << answered.delay_s;
    EXPECT_GE(answered.sigma_s, earlier) << gust;
    earlier = answered.sigma_s;
    if (gust == 0.6) {
      EXPECT_GT(std::abs(as_noise.delay_s), 3.0 * as_noise.sigma_s) << "the test shows nothing";
    }
  }
  EXPECT_GT(earlier, kDelayMatters_s / 3.0);
}

TEST(Delays, WhatIsInDoubtIsInTheError) {
  const std::vector<double> a = lively(3000, "a");
  const DelayReport report = shared_delay(
      "vane", "motion", {{.expected = a, .observed = later(a, 5), .doubted = later(a, 3)}}, kLivelyRate_Hz, {});
  EXPECT_NEAR(report.delay_s, 0.05, 0.003);
  EXPECT_NEAR(report.sigma_s, 0.03, 0.003);
  EXPECT_EQ(report.finding, DelayFinding::kWide);
}

TEST(Delays, ClockForOthersMustBeFastAndLongEnoughAndIsSearchedInItsMiddle) {
  EXPECT_FALSE(BandLimited::around(channel("gyro_x", 10.0, 60.0), 4.0).has_value());
  EXPECT_FALSE(BandLimited::around(channel("gyro_x", 100.0, 5.0), 4.0).has_value());
  const auto whole = BandLimited::around(channel("gyro_x", 50.0, 60.0), 4.0);
  ASSERT_TRUE(whole.has_value());
  EXPECT_EQ(whole->size(), 3001u);
  const auto part = BandLimited::around(channel("gyro_x", 20.0, 2000.0), 4.0);
  ASSERT_TRUE(part.has_value());
  EXPECT_NEAR(static_cast<double>(part->size()) * part->step(), kLongestDelaySearch_s, 0.1);
}

TEST(Delays, GivenOnesAreTakenOffTheStampsOfTheirGroup) {
  Recording recording;
  recording.add(channel("alpha", 10.0, 1.0));
  recording.add(channel("beta", 10.0, 1.0));
  const DelayGroup group{"vanes", {"alpha", "beta", "missing"}};
  const Study study = Study::parse("[delays]\nvanes = '20 ms'\n", "study.toml", ".");
  const DelayOptions options = DelayOptions::keys({group}).read(study.root().table("delays"));
  const std::optional<DelayReport> report = take_off_given(recording, group, options);
  ASSERT_TRUE(report.has_value());
  EXPECT_EQ(report->finding, DelayFinding::kGiven);
  EXPECT_DOUBLE_EQ(recording.at("beta").times().front(), -0.02);
  EXPECT_FALSE(take_off_given(recording, {"gps", {"alpha"}}, options).has_value());
  EXPECT_FALSE(take_off_given(recording, {"vanes", {"missing"}}, options).has_value());
}

TEST(Delays, RefuseASearchOfNoLength) {
  const Study study = Study::parse("[delays]\nmax = 0\n", "study.toml", ".");
  EXPECT_THAT(message_of([&] { static_cast<void>(DelayOptions::keys({}).read(study.root().table("delays"))); }),
              HasSubstr("delays.max"));
}

}  // namespace
}  // namespace veridyn::recording
