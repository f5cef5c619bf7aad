#include "veridyn/vehicle/identification/structure/tried_structure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace veridyn::vehicle {
namespace {

/// A usable fit that predicts as well as any.
TriedStructure fit(DriveStructure structure, double negative_log_likelihood) {
  return {.structure = structure,
          .usable = true,
          .negative_log_likelihood = negative_log_likelihood,
          .holdout_misfit = -5.0};
}

/// The first four structures, each likelier than the one before it by `gain`.
std::vector<TriedStructure> ladder(double gain) {
  std::vector<TriedStructure> tried;
  for (const DriveStructure structure :
       {DriveStructure::kBicycle, DriveStructure::kScaledAccel, DriveStructure::kRoll, DriveStructure::kRelaxation})
    tried.push_back(fit(structure, -gain * static_cast<double>(structure)));
  return tried;
}

constexpr double kJust = kLikelier + 0.01, kNotQuite = kLikelier - 0.01;

TEST(TriedStructure, IsTheSimplestWhereNoneIsLikelier) {
  EXPECT_EQ(choose_structure(ladder(0.0)), 0U);
  EXPECT_EQ(choose_structure(ladder(-100.0)), 0U);
  EXPECT_EQ(choose_structure({}), 0U);
}

TEST(TriedStructure, IsTheRichestWhereEachIsLikelierThanTheOneBefore) {
  EXPECT_EQ(choose_structure(ladder(kJust)), 3U);
}

// Gains count from what is taken so far: two that are too small each do together.
TEST(TriedStructure, ComparesWithTheOneThatIsTakenSoFar) {
  EXPECT_EQ(choose_structure(ladder(0.5 * kNotQuite)), 3U);  // the fourth, by 1.5 times it
  std::vector<TriedStructure> tried = ladder(0.0);
  tried[1].negative_log_likelihood = -100.0;
  tried[2].negative_log_likelihood = -100.0 - kNotQuite;
  tried[3].negative_log_likelihood = -100.0 - kNotQuite;
  EXPECT_EQ(choose_structure(tried), 1U);
  tried[3].negative_log_likelihood = -100.0 - kJust;
  EXPECT_EQ(choose_structure(tried), 3U);
}

TEST(TriedStructure, TakesWhatIsLikelierByMoreThanTheLimit) {
  std::vector<TriedStructure> tried = {fit(DriveStructure::kBicycle, 50.0), fit(DriveStructure::kRoll, 50.0 - kJust)};
  EXPECT_EQ(choose_structure(tried), 1U);
  tried[1].negative_log_likelihood = 50.0 - kNotQuite;
  EXPECT_EQ(choose_structure(tried), 0U);
}

// Three samples that say what one would make three times the likelihood's ratio necessary.
TEST(TriedStructure, TakesCorrelatedSamplesForFewer) {
  std::vector<TriedStructure> tried = {fit(DriveStructure::kBicycle, 0.0),
                                       fit(DriveStructure::kRoll, -2.9 * kLikelier)};
  EXPECT_EQ(choose_structure(tried), 1U);
  tried[1].inflation = 3.0;
  EXPECT_EQ(choose_structure(tried), 0U);
  tried[0].inflation = 100.0;  // that of the richer one counts
  tried[1].inflation = 2.8;
  EXPECT_EQ(choose_structure(tried), 1U);
}

TEST(TriedStructure, TakesNothingThatPredictsTheHoldoutWorse) {
  std::vector<TriedStructure> tried = {fit(DriveStructure::kBicycle, 0.0), fit(DriveStructure::kRoll, -1000.0)};
  tried[1].holdout_misfit = tried[0].holdout_misfit + 0.019;
  EXPECT_EQ(choose_structure(tried), 1U);
  tried[1].holdout_misfit = tried[0].holdout_misfit + 0.021;
  EXPECT_EQ(choose_structure(tried), 0U);
  // Without a hold-out the likelihood decides alone.
  tried[0].holdout_misfit = tried[1].holdout_misfit = kNaN;
  EXPECT_EQ(choose_structure(tried), 1U);
}

TEST(TriedStructure, TakesNothingWhoseOwnUnknownsAreAtABound) {
  std::vector<TriedStructure> tried = ladder(100.0);
  tried[3].at_bound = true;
  EXPECT_EQ(choose_structure(tried), 2U);
  tried[2].at_bound = true;
  EXPECT_EQ(choose_structure(tried), 1U);
}

TEST(TriedStructure, PassesOverFitsThatAreNotUsable) {
  std::vector<TriedStructure> tried = ladder(100.0);
  tried[0].usable = tried[1].usable = false;
  tried[0].negative_log_likelihood = tried[1].negative_log_likelihood = kNaN;
  tried[2].negative_log_likelihood = 0.0;
  tried[3].negative_log_likelihood = 4.0;
  EXPECT_EQ(choose_structure(tried), 2U);
  tried[3].negative_log_likelihood = -kJust;
  EXPECT_EQ(choose_structure(tried), 3U);
  tried[3].usable = false;
  EXPECT_EQ(choose_structure(tried), 2U);
  for (TriedStructure& t : tried) t.usable = false;
  EXPECT_EQ(choose_structure(tried), 0U);
}

TEST(TriedStructure, TakesNoEffectWhoseFitIsTheSimplerOneAtABound) {
  TriedStructure taken{.structure = DriveStructure::kRoll, .usable = true, .negative_log_likelihood = 0.0};
  TriedStructure more = taken;
  more.effects[DriveEffect::kDownforce] = true;
  more.negative_log_likelihood = -30.0;
  EXPECT_GT(probability_against(more, taken), kProbable);
  more.at_bound = true;
  EXPECT_EQ(probability_against(more, taken), 0.0);
}

// Every tyre lags: that is taken unless it is improbable. Beyond it a probability of 95 % is enough, below roll it is
// not.
TEST(TriedStructure, TakesWhatIsProbableBeyondRoll) {
  std::vector<TriedStructure> tried = {fit(DriveStructure::kRoll, 0.0), fit(DriveStructure::kRelaxation, 2.9)};
  EXPECT_EQ(choose_structure(tried), 1U);
  tried[1].negative_log_likelihood = 3.0;
  EXPECT_EQ(choose_structure(tried), 0U);
  tried = {fit(DriveStructure::kRelaxation, 0.0), fit(DriveStructure::kSaturation, -3.0)};
  EXPECT_EQ(choose_structure(tried), 1U);
  tried[1].negative_log_likelihood = -2.9;
  EXPECT_EQ(choose_structure(tried), 0U);
  tried = {fit(DriveStructure::kBicycle, 0.0), fit(DriveStructure::kRoll, -3.0)};
  EXPECT_EQ(choose_structure(tried), 0U);
}

TEST(TriedStructure, HasAProbabilityByTheRatioOfEvidences) {
  const TriedStructure roll = fit(DriveStructure::kRoll, -100.0);
  TriedStructure relaxing = fit(DriveStructure::kRelaxation, -100.0);
  EXPECT_DOUBLE_EQ(probability_against(relaxing, roll), 0.5);
  relaxing.negative_log_likelihood = -102.0;
  EXPECT_NEAR(probability_against(relaxing, roll), std::exp(2.0) / (1.0 + std::exp(2.0)), 1e-12);
  // The data narrow what it adds to a tenth of its prior: chance alone would gain it as much as that costs.
  relaxing.log_prior_volume = -std::log(10.0);
  EXPECT_NEAR(probability_against(relaxing, roll), 0.1 * std::exp(2.0) / (1.0 + 0.1 * std::exp(2.0)), 1e-12);
  EXPECT_NEAR(probability_against(relaxing, roll) + probability_against(roll, relaxing), 1.0, 1e-12);
}

TEST(TriedStructure, IsLessCertainByCorrelatedSamples) {
  const TriedStructure roll = fit(DriveStructure::kRoll, 0.0);
  TriedStructure relaxing = fit(DriveStructure::kRelaxation, -6.0);
  relaxing.inflation = 3.0;
  EXPECT_NEAR(probability_against(roll, relaxing), 1.0 / (1.0 + std::exp(2.0)), 1e-12);
  EXPECT_NEAR(probability_against(relaxing, roll), std::exp(2.0) / (1.0 + std::exp(2.0)), 1e-12);
}

TEST(TriedStructure, HasNoProbabilityWhereItWasNotFittedOrIsTheSimplerOne) {
  const TriedStructure roll = fit(DriveStructure::kRoll, 0.0);
  TriedStructure other = fit(DriveStructure::kRelaxation, -5.0);
  other.at_bound = true;
  EXPECT_EQ(probability_against(other, roll), 0.0);
  other.at_bound = other.usable = false;
  EXPECT_EQ(probability_against(other, roll), 0.0);
}

}  // namespace
}  // namespace veridyn::vehicle
