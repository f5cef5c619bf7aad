// The motion that a muscle study follows.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/muscle/muscle_studies.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::muscle {
namespace {

using test::expect_refusals;
using test::kFollow;
using test::read_muscle_study;
using testing::ElementsAre;

TEST(MuscleStudy, RampsAreTheFunctionsTheySay) {
  const MuscleStudy study = read_muscle_study(
      kFollow +
      "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nfrom = \"90 deg\"\nto = \"20 deg\"\nstart = 0.03\n"
      "duration = 0.1\nshape = \"half sine\"\n"
      "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nto = \"110 deg\"\nstart = 0.2\nduration = 0.05\n"
      "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nto = \"100 deg\"\nduration = 0.05\nshape = \"linear\"\n");
  const auto at = [&](double t) { return study.motion.coordinate[1]->evaluate(t); };
  const double q1 = 90.0 * kDegree, q2 = 20.0 * kDegree, rate = std::numbers::pi / 0.1;
  EXPECT_DOUBLE_EQ(at(0.0).value, q1);
  EXPECT_EQ(at(0.02).slope, 0.0);
  for (const double t : {0.03, 0.05, 0.0817, 0.12}) {
    // The closed form; quintics through its values, slopes and curvatures 64 to a ramp leave (pi/64)^6/46080 of the
    // rise, 3e-13 rad, and of a second derivative 4e4 times rate^2 pieces^2 less exactly.
    const double angle = rate * (t - 0.03) - std::numbers::pi / 2.0;
    EXPECT_NEAR(at(t).value, (q2 - q1) / 2.0 * std::sin(angle) + (q1 + q2) / 2.0, 1e-12);
    EXPECT_NEAR(at(t).slope, (q2 - q1) / 2.0 * rate * std::cos(angle), 1e-8);
    EXPECT_NEAR(at(t).curvature, -(q2 - q1) / 2.0 * rate * rate * std::sin(angle), 1e-3);
  }
  EXPECT_DOUBLE_EQ(at(0.15).value, q2);
  EXPECT_EQ(at(0.15).curvature, 0.0);
  // Half-way through a minimum-jerk ramp: half the rise, 15/8 of the mean speed, no acceleration.
  EXPECT_NEAR(at(0.225).value, 65.0 * kDegree, 1e-13);
  EXPECT_NEAR(at(0.225).slope, 1.875 * 90.0 * kDegree / 0.05, 1e-10);
  EXPECT_NEAR(at(0.225).curvature, 0.0, 1e-8);
  EXPECT_NEAR(at(0.26).value, 108.0 * kDegree, 1e-13);
  EXPECT_NEAR(at(0.26).slope, -10.0 * kDegree / 0.05, 1e-12);
  EXPECT_NEAR(at(0.31).value, 100.0 * kDegree, 1e-13);
  // The other coordinate rests at its default.
  EXPECT_EQ(study.motion.coordinate[0]->evaluate(0.2).value, 0.0);
  EXPECT_THAT(study.desired_coordinates, ElementsAre("elbow_flexion"));
}

TEST(MuscleStudyMotion, MistakesAreNamedWithFileLineAndKey) {
  const std::string ramp = "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nto = \"90 deg\"\nduration = 0.2\n";
  expect_refusals(
      {{kFollow, "s.toml:3: motion", "needs a motion"},
       {kFollow + "[[motion.ramp]]\ncoordinate = \"elbow\"\nto = 1\nduration = 1\n",
        "s.toml:7: motion.ramp[0].coordinate", "no coordinate 'elbow'"},
       {kFollow + ramp + "shape = \"sine\"\n", "s.toml:10", "half sine"},
       {kFollow + ramp + "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nfrom = \"80 deg\"\nto = 1\nduration = 1\n",
        "s.toml:12", "jumps"},
       {kFollow + ramp + "[[motion.ramp]]\ncoordinate = \"elbow_flexion\"\nstart = 0.1\nto = 1\nduration = 1\n",
        "s.toml:12", "before the end of the ramp before"},
       {"[subject]\nmodel = \"arm\"\nlocked = [\"elbow_flexion\"]\n[motion]\nmethod = \"computed muscle control\"\n" +
            ramp,
        "s.toml:7", "is locked and cannot follow"}});
}

}  // namespace
}  // namespace veridyn::muscle
