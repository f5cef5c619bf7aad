#include "veridyn/cueing/score/knob_effect.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace veridyn::cueing {
namespace {

const KnobEffect& of(const std::vector<KnobEffect>& effects, std::string_view knob) {
  const auto found =
      std::find_if(effects.begin(), effects.end(), [&](const KnobEffect& e) { return e.knob.name == knob; });
  if (found == effects.end()) throw std::logic_error("no such knob");
  return *found;
}

double size(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum);
}

std::vector<KnobEffect> effects(const char* algorithm, const char* platform) {
  return knob_effects(*washout_algorithm(algorithm).design(), built_in_platform(platform),
                      vestibular_model("young_meiry"), usual_thresholds());
}

TEST(KnobEffect, IsWhatTheKnobSays) {
  const auto all = effects("classical", "hexapod");
  // A larger gain is more motion; a faster washout is a shorter turn.
  const KnobEffect &gain = of(all, "force_gain"), &turn = of(all, "turn");
  EXPECT_TRUE(gain.cue == Cue::kSurge || gain.cue == Cue::kSway);
  EXPECT_GT(size(gain.platform[1]), 1.2 * size(gain.platform[0]));
  const auto optimal = effects("optimal", "hexapod");
  const KnobEffect& bumps = of(optimal, "heave_gain");
  EXPECT_EQ(bumps.cue, Cue::kHeave);
  EXPECT_GT(size(bumps.platform[1]), 1.2 * size(bumps.platform[0]));
  EXPECT_EQ(turn.cue, Cue::kYaw);
  EXPECT_LT(size(turn.platform[2]), 0.9 * size(turn.platform[0]));
  for (const KnobEffect& e : all) {
    EXPECT_FALSE(e.knob.feel.empty()) << e.knob.name;
    EXPECT_EQ(e.time.size(), e.platform[1].size());
    EXPECT_GT(size(e.vehicle), 0.0) << e.knob.name;
  }
}

TEST(KnobEffect, EveryKnobOfEveryAlgorithmDoesSomethingOnAPlatform) {
  for (const WashoutAlgorithm& a : washout_algorithms()) {
    // A hexapod shows what a platform of three axes does not, its yaw; the other platform is asked where it does not
    // do.
    const auto six = effects(std::string(a.name).c_str(), "hexapod");
    std::vector<KnobEffect> three;
    for (std::size_t i = 0; i < six.size(); ++i) {
      if (six[i].difference > 1e-3) continue;
      if (three.empty()) three = effects(std::string(a.name).c_str(), "three_axis");
      EXPECT_GT(three[i].difference, 1e-3) << a.name << " " << three[i].knob.name;
    }
  }
}

TEST(KnobEffect, TheDriveIsARigidBodysOwn) {
  const std::vector<recording::MotionSample> drive = knob_drive();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  double heading = 0.0;
  for (std::size_t k = 0; k + 1 < drive.size(); ++k) {
    const recording::MotionSample& s = drive[k];
    const double step = drive[k + 1].time - s.time;
    // Rates turn one attitude into the next; forces less gravity are accelerations of the world.
    const Eigen::Vector3d about = s.rate.norm() > 0.0 ? s.rate.normalized().eval() : Eigen::Vector3d::UnitX().eval();
    EXPECT_LT((s.attitude * Eigen::AngleAxisd(step * s.rate.norm(), about)).angularDistance(drive[k + 1].attitude),
              1e-9);
    velocity += step * (s.attitude * recording::acceleration(s));
    heading += step * s.rate.z();
  }
  // The bump leaves no speed behind; 3 m/s^2 to the side for 4.5 s turn the heading at 15 m/s.
  EXPECT_NEAR(velocity.z(), 0.0, 1e-6);
  EXPECT_NEAR(heading, 3.0 / 15.0 * 4.5, 0.02);
}

}  // namespace
}  // namespace veridyn::cueing
