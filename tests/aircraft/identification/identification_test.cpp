#include "veridyn/aircraft/identification/identification.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/aircraft/pitching_flight.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::aircraft {
namespace {

using aircraft::testing::PitchingFlight;
using estimation::Check;
using estimation::Outcome;
using ::testing::HasSubstr;
using ::testing::Not;

CoefficientResult cm_of(const PitchingFlight& flight) {
  const Subject subject = builtin_subject("thor");
  return aircraft::testing::identified_cm(subject, aircraft::testing::pitching(subject, flight));
}

estimation::Evidence row_in(const CoefficientResult& result, estimation::Check check) {
  const auto row = std::ranges::find(result.evidence, check, &estimation::Evidence::check);
  if (row == result.evidence.end()) throw std::logic_error("no row " + std::string(to_string(check)));
  return *row;
}

// The subject's own values are the start: an estimate from noisy data can be no better.
TEST(IdentificationRows, PassWhereTheFlightIsAsItsNoiseSays) {
  const CoefficientResult cm = cm_of({});
  for (const Check check :
       {Check::kMethodChoice, Check::kUnmodelledCoefficient, Check::kCoefficientHoldOut, Check::kHoldOutBands,
        Check::kHoldOutAgainstStart, Check::kPartsOfFlight, Check::kCollinearity, Check::kPlausibleSign})
    EXPECT_EQ(row_in(cm, check).outcome, Outcome::kPassed) << says(row_in(cm, check));
  EXPECT_NEAR(row_in(cm, Check::kHoldOutAgainstStart).value, 1.0, 0.01);
  EXPECT_NEAR(row_in(cm, Check::kHoldOutBands).value, 0.05, 0.02);
  EXPECT_EQ(cm.judgement.parameters.grade, estimation::Grade::kYes);
  EXPECT_EQ(cm.judgement.prediction.grade, estimation::Grade::kYes);
}

// Half the elevator was lost and is there again in the hold-out.
TEST(IdentificationRows, FindPartsThatAreNotOneAircraft) {
  const CoefficientResult cm = cm_of({.elevator = 0.5});
  EXPECT_EQ(row_in(cm, Check::kPartsOfFlight).outcome, Outcome::kFailed);
  // What the study gives is right for the hold-out.
  EXPECT_EQ(row_in(cm, Check::kHoldOutAgainstStart).outcome, Outcome::kCare);
  EXPECT_GT(row_in(cm, Check::kHoldOutAgainstStart).value, 1.5);
  EXPECT_EQ(cm.judgement.parameters.grade, estimation::Grade::kNo);
}

// Held-out data three times as noisy: the band of 95 % is one of 0.65 sigma, outside of which half of a normal
// distribution lies. The parameters are right all the same.
TEST(IdentificationRows, FindBandsThatPromiseTooMuch) {
  const CoefficientResult cm = cm_of({.later_noise = 0.006});
  EXPECT_EQ(row_in(cm, Check::kHoldOutBands).outcome, Outcome::kCare);
  EXPECT_NEAR(row_in(cm, Check::kHoldOutBands).value, 0.51, 0.04);
  EXPECT_EQ(row_in(cm, Check::kHoldOutAgainstStart).outcome, Outcome::kPassed);
  EXPECT_EQ(row_in(cm, Check::kCoefficientHoldOut).outcome, Outcome::kPassed);
}

TEST(IdentificationRows, FindWhatDoesNotPredictTheHoldOut) {
  // Mirrored, as after a servo was changed over.
  EXPECT_EQ(row_in(cm_of({.later_elevator = -1.0}), Check::kCoefficientHoldOut).outcome, Outcome::kFailed);
  // In steady flight nothing but noise is left to explain, which is no objection to the values.
  const estimation::Evidence steady = row_in(cm_of({.later_motion = 0.01}), Check::kCoefficientHoldOut);
  EXPECT_EQ(steady.outcome, Outcome::kCare);
  EXPECT_THAT(says(steady), HasSubstr("hardly varies there"));
}

TEST(IdentificationRows, FindAMomentThatNoTermMakes) {
  const CoefficientResult cm = cm_of({.unmodelled = 0.03});
  EXPECT_EQ(row_in(cm, Check::kUnmodelledCoefficient).outcome, Outcome::kFailed);
  EXPECT_GT(row_in(cm, Check::kUnmodelledCoefficient).value, 0.1);
}

// An autopilot that answers alpha with the elevator. What it does to the parameters matters where the residual holds
// more than noise.
TEST(IdentificationRows, FindAnElevatorThatMovesWithAlpha) {
  const auto collinearity = [](double unmodelled) {
    return row_in(cm_of({.unmodelled = unmodelled, .follows_alpha = 0.9}), Check::kVarianceInflation);
  };
  EXPECT_EQ(collinearity(0.02).outcome, Outcome::kCare);
  EXPECT_EQ(std::get<std::string>(collinearity(0.02).figure("names")->value), "Cm_alpha, Cm_de");
  EXPECT_EQ(collinearity(0.0).outcome, Outcome::kPassed);
  EXPECT_EQ(collinearity(0.0).cause, estimation::Cause::kCollinear) << "and the intervals hold";
}

}  // namespace
}  // namespace veridyn::aircraft
