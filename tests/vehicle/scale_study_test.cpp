#include "veridyn/vehicle/scale_study.hpp"

#include <gtest/gtest.h>

namespace veridyn::vehicle {
namespace {

// A given model that is the exact twin has no mismatch and the same motion under the similar gravity.
TEST(ScaleStudy, AnExactTwinIsFoundExact) {
  const Study study = Study::parse(
      "[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n[drive]\nmanoeuvre = \"step steer\"\nduration = 4\n"
      "[scale]\nlength_ratio = 0.2\nmass = 8.8\nspeed = 4\n",
      "study.toml");
  Progress silent;
  const ScaleStudy scale = read_scale_study(study.root(), silent);
  const ScaleAnalysis analysis = run_scale_study(scale, silent);
  EXPECT_TRUE(analysis.twin_report.similar_without_gravity());
  EXPECT_FALSE(analysis.twin_report.similar());
  ASSERT_EQ(analysis.runs.size(), 2u);
  for (const MotionDifference& d : analysis.runs[0].differences)
    EXPECT_LT(d.largest, 1e-9 * (1.0 + d.range)) << d.quantity;
  // Under the same gravity the body leans otherwise.
  double roll = 0.0;
  for (const MotionDifference& d : analysis.runs[1].differences)
    if (d.quantity == "roll") roll = d.largest / d.range;
  EXPECT_GT(roll, 0.05);
}

}  // namespace
}  // namespace veridyn::vehicle
