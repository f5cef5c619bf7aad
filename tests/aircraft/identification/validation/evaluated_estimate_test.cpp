#include "veridyn/aircraft/identification/validation/evaluated_estimate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/aircraft/pitching_flight.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/aircraft/identification/identification.hpp"
#include "veridyn/aircraft/identification/identified_estimate.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Outcome;
using ::testing::HasSubstr;

/// Judged on the whole flight, by the values of `estimate`.
CoefficientResult evaluated(const estimation::Estimate& estimate) {
  Subject subject = builtin_subject("thor");
  const FlightSignals signals = aircraft::testing::pitching(subject);
  return evaluate_estimate(aircraft::testing::only_flight(signals, aircraft::testing::pitching_segments()), subject, {},
                           estimate)
      .front();
}

estimation::Estimate cm_estimate() {
  const Subject subject = builtin_subject("thor");
  return make_estimate(subject, std::vector<CoefficientResult>{
                                    aircraft::testing::identified_cm(subject, aircraft::testing::pitching(subject))});
}

TEST(EvaluatedEstimate, HoldsForTheSameAircraftAndNotForAnother) {
  estimation::Estimate estimate = cm_estimate();
  const CoefficientResult same = evaluated(estimate);
  ASSERT_EQ(same.evidence.size(), 1U);
  EXPECT_EQ(same.evidence[0].outcome, Outcome::kPassed);
  EXPECT_GT(same.evidence[0].value, 0.9);
  EXPECT_EQ(same.judgement.prediction.grade, estimation::Grade::kYes);
  for (estimation::Parameter& p : estimate.parameters)
    if (p.name == "Cm_de") p.value = -p.value;
  const CoefficientResult other = evaluated(estimate);
  ASSERT_EQ(other.evidence.size(), 1U);
  EXPECT_EQ(other.evidence[0].outcome, Outcome::kFailed);
  EXPECT_EQ(other.verdict, estimation::GroupVerdict::kRejected);
  EXPECT_EQ(other.judgement.prediction.grade, estimation::Grade::kNo);
  // Validation says nothing of the parameters.
  EXPECT_EQ(other.judgement.parameters.grade, estimation::Grade::kNotJudged);
}

// What was not excited keeps that status in a coefficient that was rejected, and is no model of it.
TEST(EvaluatedEstimate, DoesNotTryWhatWasRejectedWhereItWasIdentified) {
  for (const char* held : {"none", "Cm_q"}) {
    estimation::Estimate estimate = cm_estimate();
    for (estimation::Parameter& p : estimate.parameters)
      p.status = p.name == held ? estimation::ParameterStatus::kNotExcited : estimation::ParameterStatus::kRejected;
    const CoefficientResult cm = evaluated(estimate);
    EXPECT_EQ(cm.reason, "Cm is not validated: it was rejected where it was identified") << held;
    EXPECT_TRUE(cm.evidence.empty()) << held;
    EXPECT_FALSE(estimation::usable(cm.verdict)) << held;
  }
}

// Of two flights the one that the model does not explain is named, and both count.
TEST(EvaluatedEstimate, SaysHowMuchOfEachFlightItExplains) {
  const Subject subject = builtin_subject("thor");
  std::vector<PreparedFlight> flights;
  for (const double elevator : {1.0, -1.0}) {
    flights.push_back(aircraft::testing::only_flight(
                          aircraft::testing::pitching(subject, {.elevator = elevator, .later_elevator = elevator}),
                          aircraft::testing::pitching_segments())
                          .front());
    flights.back().name = elevator > 0.0 ? "same.csv" : "mirrored.csv";
  }
  const CoefficientResult cm = evaluate_estimate(flights, subject, {}, cm_estimate()).front();
  ASSERT_EQ(cm.flight_fits.size(), 2U);
  EXPECT_GT(cm.flight_fits[0].fit.r2, 0.9);
  EXPECT_LT(cm.flight_fits[1].fit.r2, 0.0);
  EXPECT_THAT(cm.reason, HasSubstr("in 2 flights (same.csv 100 %, mirrored.csv 0 %)"));
  EXPECT_EQ(cm.verdict, estimation::GroupVerdict::kRejected);
}

TEST(EvaluatedEstimate, RefusesAnEstimateOfOtherCoefficients) {
  const Subject subject = builtin_subject("thor");
  estimation::Estimate estimate = cm_estimate();
  for (estimation::Parameter& p : estimate.parameters) p.name = "other_" + p.name;
  EXPECT_THAT(why([&] { (void)evaluated(estimate); }),
              HasSubstr("the estimate holds no usable parameter of the study's model"));
}

}  // namespace
}  // namespace veridyn::aircraft
