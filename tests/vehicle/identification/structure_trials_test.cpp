#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/vehicle/identification/vehicle_identification.hpp"

namespace veridyn::vehicle {
namespace {

/// A bicycle that could not be fitted, one that could, roll that was taken, and relaxation at a bound.
VehicleIdentification with_ladder() {
  VehicleIdentification id;
  id.structure = DriveStructure::kRoll;
  id.structure_reason = "structure: roll, which is likelier";
  id.tried_structures = {
      {.structure = DriveStructure::kBicycle, .message = "the search diverged"},
      {.structure = DriveStructure::kScaledAccel, .usable = true, .negative_log_likelihood = -100.0, .inflation = 3.0},
      {.structure = DriveStructure::kRoll,
       .usable = true,
       .negative_log_likelihood = -550.0,
       .inflation = 2.0,
       .holdout_rmse = 0.002,
       .value = {5e4, 6e4, 2000.0},
       .sigma = {500.0, 600.0, 30.0}},
      {.structure = DriveStructure::kRelaxation, .usable = true, .at_bound = true, .negative_log_likelihood = -551.0}};
  return id;
}

TEST(StructureTrials, SayWhatEachGainedOverTheFirstThatCouldBeFitted) {
  const estimation::Estimate estimate = make_vehicle_estimate(with_ladder(), "car");
  EXPECT_EQ(estimate.structure, "roll");
  EXPECT_EQ(estimate.structure_reason, "structure: roll, which is likelier");
  ASSERT_EQ(estimate.tried_structures.size(), 4U);
  const estimation::StructureTrial& first = estimate.tried_structures[1];
  EXPECT_EQ(first.name, "bicycle, accel_y scaled");
  EXPECT_EQ(first.log_likelihood_gain, 0.0);
  EXPECT_TRUE(std::isnan(first.needed_gain));
  const estimation::StructureTrial& roll = estimate.tried_structures[2];
  EXPECT_EQ(roll.log_likelihood_gain, 450.0);
  EXPECT_EQ(roll.needed_gain, 2.0 * kLikelier);
  EXPECT_EQ(roll.holdout_quantity, "yaw_rate");
  EXPECT_EQ(roll.holdout_rmse, 0.002);
  ASSERT_EQ(roll.parameters.size(), 3U);
  EXPECT_EQ(roll.parameters[2].name, "I_z");
  EXPECT_EQ(roll.parameters[2].value, 2000.0);
  EXPECT_EQ(roll.parameters[2].sigma, 30.0);
  EXPECT_EQ(roll.parameters[2].unit, "kg m^2");
}

TEST(StructureTrials, MarkTheOneThatIsTakenAndSayWhyOthersCannotBe) {
  const auto trials = make_vehicle_estimate(with_ladder(), "car").tried_structures;
  ASSERT_EQ(trials.size(), 4U);
  for (const estimation::StructureTrial& trial : trials) EXPECT_EQ(trial.taken, trial.name == "roll") << trial.name;
  EXPECT_EQ(trials[0].obstacle, "the search diverged");
  EXPECT_TRUE(trials[0].parameters.empty());
  EXPECT_EQ(trials[1].obstacle, "");
  EXPECT_EQ(trials[2].obstacle, "");
  EXPECT_THAT(trials[3].obstacle, ::testing::HasSubstr("at a bound"));
}

TEST(StructureTrials, AreNoneWhereOutputErrorWasNotTried) {
  const estimation::Estimate estimate = make_vehicle_estimate({}, "car");
  EXPECT_EQ(estimate.structure, "");
  EXPECT_TRUE(estimate.tried_structures.empty());
}

}  // namespace
}  // namespace veridyn::vehicle
