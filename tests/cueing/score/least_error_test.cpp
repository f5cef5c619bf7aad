#include "veridyn/cueing/score/least_error.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/cueing/platform/platform_state.hpp"
#include "veridyn/cueing/score/cueing_score.hpp"
#include "veridyn/cueing/washout/washout_design.hpp"

namespace veridyn::cueing {
namespace {

/// Swings in surge and sway with some turning, for `duration`.
std::vector<recording::MotionSample> swings(double size, double duration) {
  std::vector<recording::MotionSample> all;
  for (double t = 0.0; t < duration; t += 0.02) {
    recording::MotionSample s;
    s.time = t;
    s.frame = Frame::kFrd;
    s.force = recording::force_at_rest(Frame::kFrd) +
              size * Eigen::Vector3d(std::sin(0.7 * t) + 0.5 * std::sin(2.3 * t), 1.5 * std::sin(0.9 * t), 0.0);
    s.rate = size * Eigen::Vector3d(0.05 * std::sin(1.1 * t), 0.03 * std::sin(0.8 * t), 0.0);
    all.push_back(s);
  }
  return all;
}

std::optional<LeastError> least_of(const std::vector<recording::MotionSample>& drive, const Platform& platform,
                                   Eigen::Index pair) {
  return least_error(drive, platform, vestibular_model("young_meiry"), usual_thresholds(), pair);
}

CueingScore score_of(const CueingRun& run, const Platform& platform) {
  return score(run, felt_motion(run, vestibular_model("young_meiry"), usual_thresholds()), platform);
}

TEST(LeastError, NoAlgorithmIsBetterAndAPlatformThatStandsIsAsItSays) {
  const auto drive = swings(1.0, 40.0);
  for (const char* name : {"three_axis", "hexapod"}) {
    const Platform& platform = built_in_platform(name);
    for (const Eigen::Index pair : {0, 1}) {
      const auto least = least_of(drive, platform, pair);
      ASSERT_TRUE(least) << name;
      EXPECT_LT(least->residual, 1e-3);
      EXPECT_LT(least->error, 0.7 * least->still);
      double best = std::numeric_limits<double>::infinity();
      for (const WashoutAlgorithm& a : washout_algorithms()) {
        Progress progress;
        const auto run = drive_platform(drive, *a.design()->make(platform), platform, progress);
        best = std::min(best, score_of(run, platform).pairs[pair].value);
      }
      EXPECT_GT(best, least->error) << name;
      EXPECT_LT(best, 1.2 * least->still) << name;
    }
  }
}

/// The motion of the solution, performed with arcs, sines and levers as they are, leaves the error that it states.
TEST(LeastError, ItsMotionDoesWhatItStates) {
  const auto drive = swings(0.5, 40.0);
  const Platform& platform = built_in_platform("hexapod");
  for (const Eigen::Index pair : {0, 1}) {
    const auto least = least_of(drive, platform, pair);
    ASSERT_TRUE(least);
    ASSERT_EQ(least->time.size(), least->shift.size());
    CueingRun run;
    for (std::size_t k = 0; k + 1 < least->time.size(); ++k) {
      const auto second = [&](const std::vector<double>& x) {
        return k == 0 ? 0.0 : (x[k + 1] - 2.0 * x[k] + x[k - 1]) / (0.02 * 0.02);
      };
      const auto first = [&](const std::vector<double>& x) { return k == 0 ? 0.0 : (x[k + 1] - x[k - 1]) / 0.04; };
      PlatformState s;
      set_axis(s, pair == 0 ? PlatformAxis::kRoll : PlatformAxis::kPitch,
               {least->angle[k], first(least->angle), second(least->angle)});
      set_axis(s, pair == 0 ? PlatformAxis::kSway : PlatformAxis::kSurge,
               {least->shift[k], first(least->shift), second(least->shift)});
      run.vehicle.push_back(drive[k]);
      run.rider.push_back(rider_motion(s, platform.rider));
      run.rider.back().time = drive[k].time;
      run.steps.emplace_back();
    }
    const CueingScore s = score_of(run, platform);
    EXPECT_NEAR(s.pairs[pair].value, least->error, 0.02 * least->still);
  }
}

TEST(LeastError, KeepsTheLimitsAndGrowsAsTheyShrink) {
  const auto drive = swings(3.0, 30.0);
  Platform platform = built_in_platform("three_axis");
  double before = 0.0;
  for (const double share : {1.0, 0.5, 0.2, 0.02}) {
    AxisLimits& pitch = platform.limits[PlatformAxis::kPitch];
    pitch = built_in_platform("three_axis").limits[PlatformAxis::kPitch];
    pitch.lowest *= share;
    pitch.highest *= share;
    const auto least = least_of(drive, platform, 1);
    ASSERT_TRUE(least);
    EXPECT_GT(least->error, before);
    EXPECT_LE(least->error, least->still);
    before = least->error;
    EXPECT_LE(*std::max_element(least->angle.begin(), least->angle.end()), pitch.highest + 1e-9);
    EXPECT_GE(*std::min_element(least->angle.begin(), least->angle.end()), pitch.lowest - 1e-9);
  }
}

TEST(LeastError, SaysWhatItCannotDo) {
  const auto drive = swings(1.0, 10.0);
  EXPECT_THROW(static_cast<void>(least_error(drive, built_in_platform("hexapod"), vestibular_model("telban_cardullo"),
                                             usual_thresholds(), 0)),
               InputError);
  auto slow = drive;
  for (auto& s : slow) s.time *= 100.0;
  EXPECT_FALSE(least_of(slow, built_in_platform("hexapod"), 0));
}

}  // namespace
}  // namespace veridyn::cueing
