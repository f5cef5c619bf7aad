#include "veridyn/cueing/washout/predictive_washout.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/cueing/chain/cueing_chain.hpp"
#include "veridyn/cueing/score/felt_motion.hpp"
#include "veridyn/cueing/washout/tilt_washout.hpp"

namespace veridyn::cueing {
namespace {

recording::MotionSample accelerating(double forward, double right) {
  recording::MotionSample s;
  s.frame = Frame::kFrd;
  s.force = recording::force_at_rest(Frame::kFrd) + Eigen::Vector3d(forward, right, 0.0);
  return s;
}

TEST(PredictiveWashout, KeepsTheRateOfTiltAndThePlatformsRangeByItself) {
  PredictiveDesign design;
  design.shared.force_gain = {1.0, 1.0, 0.5};
  const Platform& platform = built_in_platform("hexapod");
  PredictiveWashout washout(design, platform);
  washout.reset(accelerating(0.0, 0.0));
  double fastest = 0.0, furthest = 0.0, tilted = 0.0;
  PlatformCommand before;
  for (int k = 0; k < 3000; ++k) {
    const double a = 8.0 * (std::sin(0.004 * k) > 0.0 ? 1.0 : -1.0);
    const PlatformCommand c = washout.step(accelerating(a, -a), 0.01);
    if (k > 0) fastest = std::max(fastest, std::abs(c.angle.y() - before.angle.y()) / 0.01);
    furthest = std::max(furthest, c.shift.cwiseAbs().maxCoeff());
    tilted = std::max(tilted, c.angle.cwiseAbs().maxCoeff());
    before = c;
  }
  EXPECT_LE(fastest, 3.0 * kDegree * (1.0 + 1e-6));
  EXPECT_GT(fastest, 2.9 * kDegree);
  EXPECT_LE(furthest, 0.95 * 0.5 + 1e-6);
  EXPECT_LE(tilted, 0.95 * 20.0 * kDegree + 1e-6);
  const PlanCounts counts = washout.counts();
  EXPECT_GT(counts.plans, 5000);
  EXPECT_EQ(counts.classical, 0);
  EXPECT_LT(static_cast<double>(counts.late), 0.01 * static_cast<double>(counts.plans)) << "8 m/s^2 either way at once";
  EXPECT_NE(washout.account().find("; 0 moments on the classical algorithm"), std::string::npos);
  EXPECT_LT(static_cast<double>(counts.iterations) / static_cast<double>(counts.plans), 15.0);
}

TEST(PredictiveWashout, FeelsMoreLikeBrakingThanTiltAlone) {
  const Platform& platform = built_in_platform("three_axis");
  const auto error = [&](const Washout& washout) {
    std::vector<recording::MotionSample> drive;
    for (int k = 0; k < 3000; ++k) {
      const double t = 0.01 * k;
      drive.push_back(accelerating(-4.0 * std::exp(-std::pow((t - 8.0) / 2.0, 2)), 3.0 * std::sin(0.5 * t)));
      drive.back().time = t;
    }
    Progress progress;
    const CueingRun run = drive_platform(drive, washout, platform, progress);
    const FeltMotion felt = felt_motion(run, vestibular_model("young_meiry"), usual_thresholds());
    double sum = 0.0;
    for (const Cue cue : {Cue::kSurge, Cue::kSway}) {
      for (std::size_t k = 0; k < drive.size(); ++k)
        sum += std::pow(felt.felt[cue].platform[k] - felt.felt[cue].vehicle[k], 2);
    }
    return sum;
  };
  PredictiveDesign design;
  design.shared.force_gain = {1.0, 1.0, 0.5};
  EXPECT_LT(error(PredictiveWashout(design, platform)), 0.9 * error(TiltWashout(TiltDesign{})));
}

// One of these led the programme round in circles, the predictor running into a bound at every step.
TEST(PlannedPair, FindsEveryPlanOfAWindingRoadFromAColdStart) {
  using Pair = PlannedPair<7, 1>;
  Pair pair(PredictiveDesign{}, built_in_platform("three_axis"), 1);
  pair.step(0.0, {}, SampleStep{});
  int problems = 0;
  for (int k = 0; k < 6000; ++k) {
    const double t = 0.01 * k, bumps = 0.8 * std::sin(23.0 * t) + 0.5 * std::sin(41.0 * t + 1.0);
    pair.step(0.6 * (7.0 * std::sin(0.4 * t) + 3.0 * std::sin(1.1 * t) + 0.3 * bumps), {}, 0.01);
    if (k % 10 != 9) continue;
    Pair::Programme programme = pair.programme();
    const numerics::ProgrammeResult r = programme.solve(pair.planned_from(), {.iterations = 50, .tolerance = 1e-8});
    EXPECT_EQ(r.end, numerics::ProgrammeEnd::kSolved) << t << " s";
    ++problems;
  }
  EXPECT_EQ(problems, 600);
}

TEST(PredictiveWashout, RefusesOrgansThatItHasNoRoomFor) {
  PredictiveDesign design;
  design.perception = "telban_cardullo";
  EXPECT_THROW(PredictiveWashout(design, built_in_platform("hexapod")), InputError);
}

}  // namespace
}  // namespace veridyn::cueing
