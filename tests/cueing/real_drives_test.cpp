// Algorithms on drives that a person drove: a rally stage in a game and a minute of freeway.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/folders.hpp"
#include "veridyn/cueing/cueing_study.hpp"

namespace veridyn::cueing {
namespace {

/// A study of examples/studies/cueing/real, untuned. Nothing where the shared data are missing.
std::optional<CueingResult> cued(const std::string& name, const std::vector<std::string>& overrides) {
  if (!std::filesystem::exists(test::shared_folder() / "data/vehicle")) return std::nullopt;
  Progress silent;
  const Study study = Study::load(test::source_folder() / "examples/studies/cueing/real" / (name + ".toml"), overrides);
  CueingStudy drive = read_study(study, silent);
  drive.tune.reset();
  return cue(drive, silent);
}

const AlgorithmResult& of(const CueingResult& result, std::string_view name) {
  return *std::find_if(result.algorithms.begin(), result.algorithms.end(),
                       [&](const AlgorithmResult& a) { return a.run.algorithm == name; });
}

/// @param rate of the tilt
void expect_better_than_the_tilt_channel(const std::string& rate) {
  std::vector<std::string> overrides = {"cue.algorithms=[\"tilt\", \"optimal\", \"mpc\"]"};
  for (const char* a : {"tilt", "optimal", "mpc"})
    overrides.push_back(std::string("washout.") + a + ".tilt_rate=\"" + rate + "\"");
  const auto result = cued("gravel_stage", overrides);
  if (!result) GTEST_SKIP() << "the shared data are not here; washout tests on simulated drives are without them";
  ASSERT_TRUE(result->least[0] && result->least[1]);
  for (const char* name : {"optimal", "mpc"}) {
    for (const Cue which : {Cue::kSurge, Cue::kSway}) {
      const CueingScore &a = of(*result, name).score, &tilt = of(*result, "tilt").score;
      const Measured pearson = difference(a, tilt, which, CueFigure::kPearson),
                     lag = difference(a, tilt, which, CueFigure::kLag);
      EXPECT_GT(pearson.low, 0.0) << name << " " << name_of(which) << " " << rate;
      EXPECT_LT(lag.high, 0.0) << name << " " << name_of(which) << " " << rate;
    }
  }
  for (const AlgorithmResult& a : result->algorithms) {
    for (std::size_t i = 3; i < kPlatformAxes; ++i) {
      const auto axis_of = static_cast<PlatformAxis>(i);
      EXPECT_LT(std::abs(axis(a.run.steps.front().ordered, axis_of).position), 0.01 * kDegree);
      EXPECT_LT(std::abs(axis(a.run.steps[1].ordered, axis_of).position), 0.01 * kDegree);
    }
    for (const std::size_t pair : {0U, 1U}) EXPECT_GT(a.score.pairs[pair].value, result->least[pair]->error);
  }
  for (const auto& least : result->least) EXPECT_LT(least->residual, 1e-6);
}

TEST(RealDrives, OnAGravelStagePlanningAndOptimalWashoutAreBetterThanTheTiltChannelBeyondTheIntervals) {
  expect_better_than_the_tilt_channel("3 deg/s");
}

TEST(RealDrivesSoak, SoTheyAreWhereTheTiltIsTwiceAsFast) { expect_better_than_the_tilt_channel("6 deg/s"); }

TEST(RealDrives, WithALapOfTheSameStagePlansCorrelateTwiceAsWellAndLagLess) {
  const auto with = cued("gravel_stage_lap", {"cue.optimum=false"});
  if (!with) GTEST_SKIP() << "the shared data are not here; LapForesight's tests are without them";
  const auto without = cued("gravel_stage_lap", {"cue.optimum=false", "cue.foresee=\"fade\""});
  const CueingScore &a = of(*with, "mpc").score, &b = of(*without, "mpc").score, &tilt = of(*with, "tilt").score;
  for (const Cue which : {Cue::kSurge, Cue::kSway}) {
    EXPECT_GT(difference(a, b, which, CueFigure::kPearson).low, 0.2) << name_of(which);
    EXPECT_LT(difference(a, b, which, CueFigure::kLag).high, -0.3) << name_of(which);
    EXPECT_GT(difference(a, tilt, which, CueFigure::kPearson).low, 0.3) << name_of(which);
  }
  EXPECT_NE(of(*with, "mpc").run.account.find("the lap foresaw 100 % of the time"), std::string::npos);
  EXPECT_EQ(of(*with, "mpc").run.account.find("misleads"), std::string::npos);
}

TEST(RealDrives, EveryHardLandingOfTheStageIsAmongTheFalseCues) {
  const auto result = cued("gravel_stage", {"cue.algorithms=[\"optimal\"]", "cue.optimum=false"});
  if (!result) GTEST_SKIP() << "the shared data are not here";
  const AlgorithmResult& a = result->algorithms.front();
  int landings = 0;
  double last = -10.0;
  for (const recording::MotionSample& s : a.run.vehicle) {
    if (-s.force.z() < 30.0 || s.time < last + 1.0) continue;
    last = s.time;
    ++landings;
    const bool listed = std::any_of(a.score.false_cues.begin(), a.score.false_cues.end(), [&](const FalseCue& f) {
      return f.cue == Cue::kHeave && f.begin < s.time + 0.5 && f.end > s.time - 0.5;
    });
    EXPECT_TRUE(listed) << s.time;
  }
  EXPECT_GT(landings, 3);
}

TEST(RealDrives, AMinuteOfFreewayIsRenderedWithGravityInItsAccelerations) {
  const auto result = cued("freeway_minute", {});
  if (!result) GTEST_SKIP() << "the shared data are not here";
  const AlgorithmResult& mpc = of(*result, "mpc");
  EXPECT_GT(mpc.score.cues[Cue::kSurge].pearson.low, 0.4);
  // The specific force at rest is not taken for heave: in the mean the platform stays in its middle.
  double mean = 0.0;
  for (const CueingStep& step : mpc.run.steps)
    mean += axis(step.ordered, PlatformAxis::kHeave).position / static_cast<double>(mpc.run.steps.size());
  EXPECT_NEAR(mean, 0.0, 0.01);
  EXPECT_LT(of(*result, "tilt").score.cues[Cue::kSurge].rmse.value, 1.0);
}

}  // namespace
}  // namespace veridyn::cueing
