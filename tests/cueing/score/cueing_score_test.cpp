#include "veridyn/cueing/score/cueing_score.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/error.hpp"
#include "veridyn/cueing/washout/washout_design.hpp"

namespace veridyn::cueing {
namespace {

std::vector<recording::MotionSample> drive_of(double seconds) {
  std::vector<recording::MotionSample> all;
  for (double t = 0.0; t < seconds; t += 0.0137) {
    recording::MotionSample s;
    s.time = t;
    s.frame = Frame::kFlu;
    s.force = recording::force_at_rest(Frame::kFlu) + Eigen::Vector3d(1.5 * std::sin(0.9 * t) + std::sin(0.31 * t),
                                                                      2.0 * std::sin(0.5 * t + std::sin(0.2 * t)),
                                                                      0.3 * std::sin(4.0 * t));
    s.rate = {0.02 * std::sin(1.1 * t), 0.03 * std::cos(1.3 * t), 0.2 * std::sin(0.5 * t)};
    all.push_back(s);
  }
  return all;
}

CueingScore scored(const std::vector<recording::MotionSample>& motion, const char* algorithm, const char* platform) {
  const Platform& p = built_in_platform(platform);
  Progress progress;
  CueingRun run = drive_platform(motion, *washout_algorithm(algorithm).design()->make(p), p, progress);
  run.algorithm = algorithm;
  return score(run, felt_motion(run, vestibular_model("young_meiry"), usual_thresholds()), p);
}

TEST(CueingScore, OfAPlatformThatDoesWhatTheVehicleDoesIsPerfect) {
  const auto motion = drive_of(100.0);
  CueingRun run;
  run.algorithm = "vehicle";
  for (const auto& s : motion) {
    run.vehicle.push_back(recording::in_frame(s, Frame::kFrd));
    run.rider.push_back(run.vehicle.back());
    run.steps.emplace_back();
  }
  const Platform& p = built_in_platform("hexapod");
  const CueingScore s = score(run, felt_motion(run, vestibular_model("young_meiry"), usual_thresholds()), p);
  for (std::size_t i = 0; i < kCues; ++i) {
    EXPECT_EQ(s.cues[i].rmse.value, 0.0);
    EXPECT_NEAR(s.cues[i].pearson.value, 1.0, 1e-12);
    EXPECT_NEAR(s.cues[i].lag.value, 0.0, 1e-9);
    EXPECT_EQ(s.cues[i].above.value, 0.0);
  }
  EXPECT_TRUE(s.false_cues.empty());
}

TEST(CueingScore, TellsALatePlatformFromAWrongOne) {
  const auto motion = drive_of(120.0);
  CueingRun late, wrong;
  for (std::size_t k = 0; k < motion.size(); ++k) {
    for (CueingRun* run : {&late, &wrong}) {
      run->vehicle.push_back(recording::in_frame(motion[k], Frame::kFrd));
      run->steps.emplace_back();
    }
    late.rider.push_back(recording::in_frame(motion[k < 29 ? 0 : k - 29], Frame::kFrd));  // 0.4 s
    late.rider.back().time = motion[k].time;
    wrong.rider.push_back(late.vehicle.back());
    wrong.rider.back().force.y() *= -1.0;
  }
  const Platform& p = built_in_platform("hexapod");
  const auto of = [&](const CueingRun& run) {
    return score(run, felt_motion(run, vestibular_model("young_meiry"), usual_thresholds()), p);
  };
  EXPECT_NEAR(of(late).cues[Cue::kSurge].lag.value, 29 * 0.0137, 0.01);
  EXPECT_GT(of(late).cues[Cue::kSurge].at_lag.value, 0.999);
  const CueingScore turned = of(wrong);
  EXPECT_NEAR(turned.cues[Cue::kSway].pearson.value, -1.0, 1e-9);
  EXPECT_GT(turned.false_cues.size(), 10u);
  for (const FalseCue& f : turned.false_cues) {
    EXPECT_EQ(f.cue, Cue::kSway);
    EXPECT_EQ(f.kind, FalseCue::Kind::kWrongSign);
  }
}

TEST(CueingScore, AFasterTiltIsBetterBeyondItsInterval) {
  const auto motion = drive_of(200.0);
  const Platform& p = built_in_platform("three_axis");
  Progress progress;
  const auto of = [&](double rate) {
    const auto design = washout_algorithm("tilt").design();
    for (Knob& knob : design->knobs()) {
      if (knob.name == "tilt_rate") knob.values[0] = rate * kDegree;
    }
    const CueingRun run = drive_platform(motion, *design->make(p), p, progress);
    return score(run, felt_motion(run, vestibular_model("young_meiry"), usual_thresholds()), p);
  };
  const CueingScore slow = of(2.0), fast = of(6.0);
  const Measured better = difference(fast, slow, Cue::kSway, CueFigure::kPhysicalPearson);
  EXPECT_GT(better.low, 0.0);
  const Measured none = difference(fast, fast, Cue::kSway, CueFigure::kPhysicalPearson);
  EXPECT_EQ(none.low, 0.0);
  EXPECT_EQ(none.high, 0.0);
  EXPECT_GT(fast.axes[PlatformAxis::kRoll].rate, slow.axes[PlatformAxis::kRoll].rate);
}

TEST(CueingScore, SaysWhatThePlatformUsed) {
  const CueingScore s = scored(drive_of(100.0), "classical", "hexapod");
  EXPECT_GT(s.axes[PlatformAxis::kSurge].used, 0.5);
  EXPECT_LE(s.axes[PlatformAxis::kSurge].used, 1.0);
  EXPECT_GT(s.axes[PlatformAxis::kSurge].limited, 0.0);
  EXPECT_GT(s.leg_speed, 0.05);
  EXPECT_LE(s.leg_speed, 1.001);
  EXPECT_EQ(scored(drive_of(100.0), "classical", "three_axis").axes[PlatformAxis::kSurge].used, 0.0);
}

TEST(CueingScore, OfAFewSecondsThereIsNone) {
  EXPECT_THROW(scored(drive_of(2.0), "classical", "hexapod"), InputError);
  const CueingScore brief = scored(drive_of(20.0), "classical", "hexapod");
  EXPECT_TRUE(std::isnan(brief.cues[Cue::kSway].pearson.low));
  EXPECT_EQ(brief.notes.size(), 1u);
}

}  // namespace
}  // namespace veridyn::cueing
