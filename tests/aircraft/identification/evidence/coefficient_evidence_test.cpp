#include "veridyn/aircraft/identification/evidence/coefficient_evidence.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <tuple>

#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/estimation/regression/regression_evidence.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
using estimation::Grade;
using estimation::Outcome;
using ::testing::HasSubstr;

CoefficientChecks sound() {
  CoefficientChecks checks;
  checks.error_ratio = 1.0;
  checks.has_holdout = true;
  checks.holdout_fit.r2 = 0.95;
  checks.contradiction_p = 0.4;
  return checks;
}

estimation::RegressionComparison recommended() {
  estimation::RegressionComparison comparison;
  comparison.recommends = true;
  comparison.reason = "GTLS: fine";
  return comparison;
}

estimation::Judgement judged(const CoefficientChecks& checks,
                             const estimation::RegressionComparison& comparison = recommended(),
                             const IdentifyOptions& options = {}) {
  return estimation::judge(coefficient_evidence("CL", checks, comparison, options));
}

TEST(CoefficientEvidence, OfASoundEstimateIsYes) {
  EXPECT_EQ(judged(sound()).parameters.grade, Grade::kYes);
  EXPECT_EQ(judged(sound()).prediction.grade, Grade::kYes);
}

TEST(CoefficientEvidence, KeepsPredictionWhereOnlyTheParametersAreBiased) {
  CoefficientChecks checks = sound();
  checks.unmodelled_share = 0.2;
  checks.error_ratio = 30.0;
  const estimation::Judgement judgement = judged(checks);
  EXPECT_EQ(judgement.parameters.grade, Grade::kNo);
  EXPECT_EQ(judgement.prediction.grade, Grade::kYes);
  EXPECT_EQ(estimation::verdict_of(judgement), estimation::GroupVerdict::kEffective);
}

TEST(CoefficientEvidence, WithoutAHoldOutPredictionIsNotJudged) {
  CoefficientChecks checks = sound();
  checks.has_holdout = false;
  EXPECT_EQ(judged(checks).prediction.grade, Grade::kNotJudged);
  EXPECT_EQ(judged(checks).parameters.grade, Grade::kYes);
}

TEST(CoefficientEvidence, OfWhatDoesNotPredictIsNo) {
  CoefficientChecks checks = sound();
  checks.holdout_fit.r2 = -74.0;
  checks.holdout_ratio = 9.0;
  EXPECT_EQ(judged(checks).prediction.grade, Grade::kNo);
  EXPECT_EQ(estimation::verdict_of(judged(checks)), estimation::GroupVerdict::kRejected);
}

// Drag in cruise: what is not explained is no more than the sensors' noise, so its parameters are as good as their
// intervals.
TEST(CoefficientEvidence, OfWhatHardlyVariesOnTheHoldOutIsCareOfPredictionOnly) {
  CoefficientChecks checks = sound();
  checks.holdout_fit.r2 = 0.1;
  checks.holdout_ratio = 1.2;
  EXPECT_EQ(judged(checks).prediction.grade, Grade::kWithCare);
  EXPECT_EQ(judged(checks).parameters.grade, Grade::kYes);
  checks.holdout_ratio = 4.5;
  EXPECT_EQ(judged(checks).parameters.grade, Grade::kNo);
}

TEST(CoefficientEvidence, TakesAMethodThatTheUserFixesWithCare) {
  estimation::RegressionComparison none = recommended();
  none.recommends = false;
  EXPECT_EQ(judged(sound(), none).parameters.grade, Grade::kNo);
  IdentifyOptions fixed;
  fixed.method = estimation::Method::kOls;
  EXPECT_EQ(judged(sound(), none, fixed).parameters.grade, Grade::kWithCare);
}

TEST(CoefficientEvidence, CollinearityMattersWhereTheResidualIsMoreThanNoise) {
  estimation::RegressionComparison comparison = recommended();
  comparison.estimates.push_back({.condition_number = 1000.0});
  CoefficientChecks checks = sound();
  EXPECT_EQ(judged(checks, comparison).parameters.grade, Grade::kYes);
  checks.error_ratio = 9.0;
  EXPECT_EQ(judged(checks, comparison).parameters.grade, Grade::kWithCare);
}

Evidence row_of(const CoefficientChecks& checks, Check check,
                const estimation::RegressionComparison& comparison = recommended()) {
  const std::vector<Evidence> rows = coefficient_evidence("CL", checks, comparison, {});
  const auto found = std::ranges::find(rows, check, &Evidence::check);
  return found == rows.end() ? Evidence{.outcome = Outcome::kMissing} : *found;
}

TEST(CoefficientEvidence, PartsOfTheFlightThatContradictEachOtherRefuseTheParameters) {
  CoefficientChecks checks = sound();
  checks.scatter = 2.25;
  EXPECT_EQ(row_of(checks, Check::kPartsOfFlight).outcome, Outcome::kPassed);
  EXPECT_THAT(says(row_of(checks, Check::kPartsOfFlight)), HasSubstr("widened by 1.50"));
  checks.contradiction_p = 1e-4;
  EXPECT_EQ(row_of(checks, Check::kPartsOfFlight).outcome, Outcome::kFailed);
  EXPECT_EQ(judged(checks).parameters.grade, Grade::kNo);
  EXPECT_EQ(judged(checks).prediction.grade, Grade::kYes);
}

TEST(CoefficientEvidence, BandsThatDoNotHoldOnTheHoldOutAreCareOfPrediction) {
  CoefficientChecks checks = sound();
  checks.outside_bands = 0.08;
  EXPECT_EQ(row_of(checks, Check::kHoldOutBands).outcome, Outcome::kPassed);
  checks.outside_bands = 0.25;
  EXPECT_EQ(row_of(checks, Check::kHoldOutBands).outcome, Outcome::kCare);
  EXPECT_EQ(judged(checks).prediction.grade, Grade::kWithCare);
  EXPECT_EQ(judged(checks).parameters.grade, Grade::kYes);
}

TEST(CoefficientEvidence, StartValuesThatPredictBetterAreCareOfPrediction) {
  CoefficientChecks checks = sound();
  EXPECT_EQ(row_of(checks, Check::kHoldOutAgainstStart).outcome, Outcome::kMissing) << "none were given";
  checks.error_over_start = 1.01;
  EXPECT_EQ(row_of(checks, Check::kHoldOutAgainstStart).outcome, Outcome::kPassed);
  checks.error_over_start = 1.3;
  EXPECT_EQ(judged(checks).prediction.grade, Grade::kWithCare);
  EXPECT_THAT(says(row_of(checks, Check::kHoldOutAgainstStart)), HasSubstr("predict better"));
}

// A model that lacks a fifth of the variance predicts as far as it goes.
TEST(CoefficientEvidence, AWeakModelThatPredictsIsCareOfPrediction) {
  CoefficientChecks checks = sound();
  checks.unmodelled_share = 0.19;
  EXPECT_EQ(row_of(checks, Check::kCoefficientHoldOut).outcome, Outcome::kPassed);
  checks.unmodelled_share = 0.25;
  EXPECT_EQ(row_of(checks, Check::kCoefficientHoldOut).outcome, Outcome::kCare);
  EXPECT_EQ(judged(checks).prediction.grade, Grade::kWithCare);
}

TEST(CoefficientEvidence, SaysWhichMethodMayBeRecommendedAndWhyNone) {
  const Evidence some = row_of(sound(), Check::kMethodChoice);
  EXPECT_EQ(some.outcome, Outcome::kPassed);
  EXPECT_EQ(says(some), "GTLS: fine");
  estimation::RegressionComparison none = recommended();
  none.recommends = false;
  none.reason = "none: the residual variance is 40 of what the assumed errors give";
  EXPECT_EQ(row_of(sound(), Check::kMethodChoice, none).outcome, Outcome::kFailed);
  EXPECT_THAT(judged(sound(), none).parameters.decided_by, ::testing::ElementsAre(none.reason));
  EXPECT_EQ(judged(sound(), none).prediction.grade, Grade::kYes);
}

// Every row is about its coefficient, so that grades of several do not mix.
TEST(CoefficientEvidence, IsAboutItsCoefficient) {
  CoefficientChecks checks = sound();
  checks.error_over_start = 1.0;
  estimation::RegressionComparison comparison = recommended();
  comparison.estimates.push_back({.condition_number = 1.0});
  std::vector<Check> made;
  for (const Evidence& row : coefficient_evidence("CL", checks, comparison, {})) {
    EXPECT_EQ(row.about, "CL") << name_of(row);
    made.push_back(row.check);
  }
  EXPECT_THAT(
      made, ::testing::UnorderedElementsAre(Check::kMethodChoice, Check::kUnmodelledCoefficient,
                                            Check::kCoefficientHoldOut, Check::kHoldOutBands,
                                            Check::kHoldOutAgainstStart, Check::kPartsOfFlight, Check::kCollinearity));
}

estimation::Parameter parameter(std::string name, double value, double sigma) {
  return {.name = std::move(name), .value = value, .sigma = sigma};
}

// Two controls that an autopilot mixes: a variance inflation of 40, with 98 % of the hold-out explained.
TEST(CoefficientEvidence, CollinearParametersAreWithCare) {
  std::vector<estimation::Parameter> parameters{parameter("CY_da", 0.1, 0.01), parameter("CY_dr", 0.2, 0.01),
                                                parameter("CY_beta", -0.7, 0.01)};
  for (estimation::Parameter& p : parameters) p.status = estimation::ParameterStatus::kIdentified;
  parameters[0].variance_inflation = parameters[1].variance_inflation = 40.0;
  estimation::RegressionEstimate estimate;
  estimate.condition_number = 80.0;
  estimate.parameters = parameters;
  estimation::RegressionComparison comparison = recommended();
  comparison.estimates = {estimate};
  CoefficientChecks checks = sound();
  checks.holdout_fit.r2 = 0.98;
  checks.error_ratio = 9.0;
  const std::vector<Evidence> rows = coefficient_evidence("CY", checks, comparison, {});
  EXPECT_EQ(estimation::judge(rows).parameters.grade, Grade::kWithCare);
  // Where the residual is noise alone their intervals hold: they are as wide as the inflation makes them.
  checks.error_ratio = 1.0;
  EXPECT_EQ(estimation::judge(coefficient_evidence("CY", checks, comparison, {})).parameters.grade, Grade::kYes);
}

TEST(Plausibility, PassesTheValuesOfEveryBuiltInAircraft) {
  for (const std::string& name : builtin_subject_names()) {
    const Subject subject = builtin_subject(name);
    for (const auto& model : subject.model.coefficients) {
      if (!model) continue;
      std::vector<estimation::Parameter> parameters;
      for (std::size_t i = 0; i < model->size(); ++i)
        parameters.push_back(parameter(model->parameter_names()[i], model->values[i], 1e-3));
      for (const Evidence& row : plausibility(model->coefficient, parameters, subject))
        EXPECT_EQ(row.outcome, Outcome::kPassed) << name << ": " << says(row);
    }
  }
}

TEST(Plausibility, TakesAWrongSignOrAnImpossibleLiftSlopeWithCare) {
  const Subject subject = builtin_subject("unatrap");
  const auto row = [&](Coefficient c, const char* name, double value, double sigma) {
    const std::vector<estimation::Parameter> parameters{parameter(name, value, sigma)};
    return plausibility(c, parameters, subject).back();
  };
  EXPECT_EQ(row(Coefficient::kCY, "CY_beta", 0.67, 0.01).outcome, Outcome::kCare);
  EXPECT_THAT(advice_of(row(Coefficient::kCY, "CY_beta", 0.67, 0.01)), HasSubstr("sign of beta"));
  EXPECT_EQ(row(Coefficient::kCY, "CY_beta", 0.67, 0.5).outcome, Outcome::kNotVerified) << "no more than noise";
  EXPECT_EQ(row(Coefficient::kCm, "Cm_q", 1.75, 31.0).outcome, Outcome::kNotVerified);
  EXPECT_THAT(says(row(Coefficient::kCm, "Cm_q", 1.75, 31.0)), HasSubstr("not determined"));
  for (const auto& [c, name, right] : {std::tuple{Coefficient::kCL, "CL_alpha", 4.0},
                                       {Coefficient::kCD, "CD_0", 0.05},
                                       {Coefficient::kCY, "CY_beta", -0.7},
                                       {Coefficient::kCl, "Cl_p", -0.5},
                                       {Coefficient::kCm, "Cm_q", -10.0},
                                       {Coefficient::kCn, "Cn_r", -0.2}}) {
    EXPECT_EQ(row(c, name, right, 0.01).outcome, Outcome::kPassed) << name;
    EXPECT_EQ(row(c, name, -right, 0.01).outcome, Outcome::kCare) << name;
  }
  // Aspect ratio 8: Helmbold's formula gives 4.9 per rad.
  EXPECT_EQ(row(Coefficient::kCL, "CL_alpha", 3.6, 0.05).outcome, Outcome::kPassed);
  EXPECT_EQ(row(Coefficient::kCL, "CL_alpha", 1.8, 0.05).outcome, Outcome::kCare);
  EXPECT_EQ(row(Coefficient::kCL, "CL_alpha", 12.0, 0.05).outcome, Outcome::kCare);
}

TEST(CoefficientEvidence, SaysHowMuchLargerTheResidualIsThanTheSensorsLeave) {
  CoefficientChecks checks = sound();
  checks.error_ratio = 9.0;
  checks.unmodelled_share = 0.25;
  const Evidence row = row_of(checks, Check::kUnmodelledCoefficient);
  EXPECT_EQ(row.outcome, Outcome::kFailed);
  EXPECT_EQ(row.cause, Cause::kMissingTerm);
  EXPECT_THAT(says(row), HasSubstr("25 % of its variance"));
  EXPECT_THAT(says(row), HasSubstr("residual 3.0 times"));
}

// Where the errors of the regressors leave no signal, the ratio is unknown or, as a difference of variances, negative:
// this used to print "residual -nan times".
TEST(CoefficientEvidence, PrintsNoRatioWhereTheRegressorsLeaveNoSignal) {
  for (const double ratio : {kNaN, -0.4, 0.0}) {
    CoefficientChecks checks = sound();
    checks.error_ratio = ratio;
    checks.unmodelled_share = ratio == ratio ? 1.2 : kNaN;
    const Evidence row = row_of(checks, Check::kUnmodelledCoefficient);
    EXPECT_EQ(row.cause, Cause::kNoise);
    EXPECT_THAT(says(row), Not(HasSubstr("nan"))) << ratio;
  }
}

// What misses by more than the mean of the hold-out does is not identified, however small its residual.
TEST(CoefficientEvidence, OfWhatPredictsWorseThanTheMeanIsNo) {
  CoefficientChecks checks = sound();
  checks.holdout_fit.r2 = -0.94;
  checks.holdout_ratio = 1.2;
  EXPECT_EQ(judged(checks).parameters.grade, Grade::kNo);
  EXPECT_EQ(estimation::verdict_of(judged(checks)), estimation::GroupVerdict::kRejected);
}

}  // namespace
}  // namespace veridyn::aircraft
