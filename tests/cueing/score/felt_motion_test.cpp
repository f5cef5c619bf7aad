#include "veridyn/cueing/score/felt_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/refusal.hpp"

namespace veridyn::cueing {
namespace {

/// A vehicle that swings under a steady push, and a rider at rest.
CueingRun swinging() {
  CueingRun run;
  for (int k = 0; k < 400; ++k) {
    recording::MotionSample s;
    s.frame = Frame::kFrd;
    s.time = 0.01 * k;
    s.force = recording::force_at_rest(Frame::kFrd);
    run.rider.push_back(s);
    s.force += Eigen::Vector3d(0.5, std::sin(2.0 * s.time), 0.0);
    s.rate = {0.0, 0.0, 0.1 * s.time};
    run.vehicle.push_back(s);
  }
  return run;
}

TEST(FeltMotion, IsTheOrgansAnswerWithoutGravityInHeave) {
  const CueingRun run = swinging();
  const VestibularModel& model = vestibular_model("young_meiry");
  const FeltMotion felt = felt_motion(run, model, usual_thresholds());
  ASSERT_EQ(felt.time.size(), 400U);
  Perception alone(model);
  for (std::size_t k = 0; k < 400; ++k) {
    const Eigen::Vector3d force(0.5, std::sin(0.02 * static_cast<double>(k)), 0.0), &rate = run.vehicle[k].rate;
    const Perception::Felt f = k == 0 ? alone.reset(force, rate) : alone.step(force, rate, 0.01);
    ASSERT_NEAR(felt.felt[Cue::kSway].vehicle[k], f.force.y(), 1e-9) << k;
    ASSERT_NEAR(felt.felt[Cue::kYaw].vehicle[k], f.rate.z(), 1e-9) << k;
    ASSERT_NEAR(felt.physical[Cue::kSurge].vehicle[k], 0.5, 1e-12);
    for (const Cue cue : kAllCues) ASSERT_NEAR(felt.felt[cue].platform[k], 0.0, 1e-9) << "the rider is at rest";
  }
  EXPECT_EQ(felt.threshold[Cue::kHeave], usual_thresholds().force[2]);
  EXPECT_EQ(felt.threshold[Cue::kRoll], usual_thresholds().rate[0]);
}

TEST(FeltMotion, RefusesAModelOfANervesFiringRate) {
  EXPECT_NE(why([] {
              (void)felt_motion(swinging(), vestibular_model("ormsby"), usual_thresholds());
            }).find("'ormsby' answers in a nerve's firing rate"),
            std::string::npos);
}

}  // namespace
}  // namespace veridyn::cueing
