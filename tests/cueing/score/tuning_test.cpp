#include "veridyn/cueing/score/tuning.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::cueing {
namespace {

std::vector<recording::MotionSample> lap(double phase) {
  std::vector<recording::MotionSample> all;
  for (double t = 0.0; t < 40.0; t += 0.02) {
    recording::MotionSample s;
    s.time = t;
    s.frame = Frame::kFrd;
    s.force = recording::force_at_rest(Frame::kFrd) +
              Eigen::Vector3d(1.2 * std::sin(0.4 * t + phase) + 0.5 * std::sin(1.9 * t),
                              1.5 * std::sin(0.3 * t + 2.0 * phase), 0.0);
    all.push_back(s);
  }
  return all;
}

double cost_of(const WashoutDesign& design, const Platform& platform,
               const std::vector<recording::MotionSample>& drive) {
  Progress progress;
  const CueingRun run = drive_platform(drive, *design.make(platform), platform, progress);
  return tuning_cost(run, felt_motion(run, vestibular_model("young_meiry"), usual_thresholds()), {});
}

TEST(Tuning, LowersTheCostOnItsDriveAndOnAnotherOne) {
  const Platform& platform = built_in_platform("hexapod");
  const auto design = washout_algorithm("classical").design();
  Progress progress;
  TuningOptions options;
  options.evaluations = 80;
  const Tuning t =
      tuned(*design, platform, lap(0.0), vestibular_model("young_meiry"), usual_thresholds(), options, progress);
  EXPECT_FALSE(t.knobs.empty());
  EXPECT_LT(t.cost_after, 0.9 * t.cost_before);
  EXPECT_NEAR(cost_of(*t.design, platform, lap(0.0)), t.cost_after, 1e-12);
  EXPECT_LT(cost_of(*t.design, platform, lap(1.0)), cost_of(*design, platform, lap(1.0)));
  EXPECT_LE(t.evaluations, 80u);
}

TEST(Tuning, OfAPlatformThatStandsStillCostsMostAndOfOneThatMovesAsTheVehicleNothing) {
  const auto drive = lap(0.0);
  CueingRun run;
  for (const auto& s : drive) {
    run.vehicle.push_back(s);
    run.rider.push_back(s);
    run.rider.back().force = recording::force_at_rest(Frame::kFrd);
    run.steps.emplace_back();
  }
  const auto cost = [&] {
    return tuning_cost(run, felt_motion(run, vestibular_model("young_meiry"), usual_thresholds()), {});
  };
  EXPECT_NEAR(cost(), 1.5, 1e-12);
  // A scale is not noticed; too little is.
  const auto scaled = [&](double share) {
    for (std::size_t k = 0; k < drive.size(); ++k)
      run.rider[k].force = (1.0 - share) * recording::force_at_rest(Frame::kFrd) + share * drive[k].force;
    return cost();
  };
  EXPECT_NEAR(scaled(1.0), 0.0, 1e-12);
  EXPECT_NEAR(scaled(0.3), 0.0, 1e-12);
  EXPECT_NEAR(scaled(0.1), 0.25, 1e-12);
  EXPECT_NEAR(scaled(1.2), 0.1, 1e-12);
}

}  // namespace
}  // namespace veridyn::cueing
