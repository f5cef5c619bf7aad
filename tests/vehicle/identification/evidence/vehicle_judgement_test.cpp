#include "veridyn/vehicle/identification/evidence/vehicle_judgement.hpp"

#include <gmock/gmock.h>

#include <algorithm>

namespace veridyn::vehicle {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

estimation::PredictedQuantity yaw_rate(double r2, double rmse, double lag1 = 0.0) {
  estimation::PredictedQuantity q{.name = "yaw_rate", .unit = "rad/s", .fit = {}, .lag1 = lag1};
  q.fit.r2 = r2;
  q.fit.rmse = rmse;
  return q;
}

std::vector<std::string> not_passed(const VehicleJudgement& judgement) {
  std::vector<std::string> texts;
  for (const estimation::Evidence& row : judgement.checks)
    if (!row.passed()) texts.push_back(row.text);
  return texts;
}

/// A drive whose gyro has noise of 0.01 rad/s, and an estimate that says which of its parameters are excited.
struct Case {
  DriveSignals signals;
  DriveSegments segments;
  VehicleParameters<double> start;
  DriveSignalOptions signal_options;
  VehicleIdentifyOptions options;
  VehicleEstimate estimate;
  DriveValidation fit, validation, by_noise;

  Case() {
    signals[DriveSignal::kYawRate].sigma = 0.01;
    estimate.method = VehicleMethod::kOutputError;
    start.mass = 1100.0;
    start.a = 1.2;
    start.b = 1.4;
    for (const char* name : {"C_f", "C_r", "steer_bias"}) {
      estimation::Parameter p;
      p.name = name;
      p.value = p.name == "steer_bias" ? 0.01 : 6e4;
      p.sigma = 0.01 * p.value;
      p.status = estimation::ParameterStatus::kIdentified;
      estimate.parameters.push_back(p);
    }
    fit.quantities = {yaw_rate(0.99, 0.01)};
    validation.quantities = {yaw_rate(0.98, 0.011)};
  }
  [[nodiscard]] VehicleJudgement judge() const {
    return judge_vehicle({signals, segments, start, signal_options, options},
                         {.chosen = estimate, .fit = fit, .validation = validation, .by_noise = by_noise});
  }
};

TEST(VehicleJudgement, EstimateThatPredictsTheHoldOutIsIdentified) {
  const VehicleJudgement found = Case().judge();
  EXPECT_EQ(found.verdict, estimation::GroupVerdict::kIdentified);
  EXPECT_EQ(found.reason, "C_f, C_r identified by output error: 98.0 % of the yaw rate's variance on the hold-out");
  EXPECT_THAT(not_passed(found), ::testing::IsEmpty());
  EXPECT_EQ(found.judgement.parameters.grade, estimation::Grade::kYes);
  EXPECT_EQ(found.judgement.prediction.grade, estimation::Grade::kYes);
}

TEST(VehicleJudgement, PoorPredictionOfTheHoldOutRejects) {
  Case c;
  c.validation.quantities = {yaw_rate(0.4, 0.011)};
  const VehicleJudgement found = c.judge();
  EXPECT_EQ(found.verdict, estimation::GroupVerdict::kRejected);
  EXPECT_EQ(found.reason, "rejected: it explains 40 % of the yaw rate's variance on the hold-out, less than 50 %");
  EXPECT_THAT(not_passed(found),
              ElementsAre("it explains 40 % of the yaw rate's variance on the hold-out, less than 50 %"));
}

// A car whose body rolls: predicted well by a bicycle whose values make up for the rolling.
TEST(VehicleJudgement, MotionThatTheBicycleDoesNotHaveLeavesThePredictionOnly) {
  Case c;
  c.fit.quantities = {yaw_rate(0.7, 0.2, 0.9)};
  const VehicleJudgement found = c.judge();
  EXPECT_EQ(found.verdict, estimation::GroupVerdict::kEffective);
  EXPECT_THAT(found.reason, HasSubstr("its values are no physical constants: the residual of yaw_rate is"));
  EXPECT_THAT(not_passed(found),
              ::testing::Contains(HasSubstr("30 % of the variance of yaw_rate is neither modelled nor noise")));
  EXPECT_EQ(found.judgement.parameters.grade, estimation::Grade::kNo);
  EXPECT_EQ(found.judgement.prediction.grade, estimation::Grade::kYes);
}

TEST(VehicleJudgement, StiffnessThatNoTyreHasIsNoPhysicalConstant) {
  Case c;
  c.estimate.parameters[0].value = 6e6;
  const VehicleJudgement found = c.judge();
  EXPECT_EQ(found.verdict, estimation::GroupVerdict::kEffective);
  EXPECT_THAT(found.reason, HasSubstr("times the static wheel load per rad, where vehicles have 4 to 40"));
}

TEST(VehicleJudgement, TheSameResidualIsAllowedWhereNoisyInputsExplainIt) {
  Case c;
  c.fit.quantities = {yaw_rate(0.7, 0.2, 0.9)};
  c.by_noise.quantities = {yaw_rate(0.0, 0.19)};
  EXPECT_EQ(c.judge().verdict, estimation::GroupVerdict::kIdentified);
}

TEST(VehicleJudgement, DriveThatDeterminesNoParameterOfTheVehicleIsNotExcited) {
  Case c;
  for (std::size_t i = 0; i < 2; ++i) c.estimate.parameters[i].status = estimation::ParameterStatus::kNotExcited;
  const VehicleJudgement found = c.judge();
  EXPECT_EQ(found.verdict, estimation::GroupVerdict::kNotExcited);
  EXPECT_EQ(found.reason, "not excited: the drive does not determine C_f, C_r");
  EXPECT_EQ(found.judgement.parameters.grade, estimation::Grade::kNo);
  EXPECT_EQ(found.judgement.prediction.grade, estimation::Grade::kNotJudged);
}

TEST(VehicleJudgement, ModelThatCannotBeSimulatedIsRejectedAndAMissingHoldOutIsSaid) {
  Case c;
  c.validation.quantities.clear();
  EXPECT_EQ(c.judge().verdict, estimation::GroupVerdict::kIdentified);
  EXPECT_THAT(not_passed(c.judge()), ElementsAre("there was no hold-out to validate on, so prediction is not judged"));
  EXPECT_EQ(c.judge().judgement.prediction.grade, estimation::Grade::kNotJudged);
  c.fit.quantities.clear();
  EXPECT_EQ(c.judge().reason, "rejected: the identified model cannot be simulated over the drive");
}

TEST(VehicleJudgement, RegressionsThatBelongToNoBicycleReject) {
  Case c;
  EquationErrorEstimates equation_error;
  AxleEstimate axle;
  axle.method = estimation::Method::kGtls;
  axle.usable = true;
  axle.consistency_p = 1e-6;
  equation_error.regression.axles = {axle};
  const VehicleProblem problem{c.signals, c.segments, c.start, c.signal_options, c.options};
  const VehicleFindings findings{.chosen = c.estimate,
                                 .equation_error = &equation_error,
                                 .fit = c.fit,
                                 .validation = c.validation,
                                 .by_noise = c.by_noise};
  EXPECT_EQ(judge_vehicle(problem, findings).verdict, estimation::GroupVerdict::kEffective);
  EXPECT_THAT(judge_vehicle(problem, findings).reason, HasSubstr("belong to no bicycle (p = 1.0e-06)"));
  // Equation error knows linear tyres only.
  c.options.model.tyre = kDriveTyre<SimpleMagicFormulaTyre>;
  EXPECT_EQ(judge_vehicle(problem, findings).verdict, estimation::GroupVerdict::kIdentified);
}

estimation::Evidence judged_row(const VehicleJudgement& judgement, std::string_view name) {
  const auto row = std::ranges::find(judgement.checks, name, &estimation::Evidence::name);
  if (row == judgement.checks.end()) throw std::logic_error("no row " + std::string(name));
  return *row;
}

// Noise is known to a factor of two: up to there an autocorrelated residual needs care, and a white one is noise.
TEST(VehicleJudgement, GradesAResidualByItsSizeAndItsAutocorrelation) {
  using estimation::Outcome;
  const auto outcome = [](double rmse, double lag1) {
    Case c;
    c.fit.quantities = {yaw_rate(0.99, rmse, lag1)};
    c.validation.quantities = {yaw_rate(0.98, rmse, lag1)};
    return judged_row(c.judge(), "residual beyond the sensors").outcome;
  };
  EXPECT_EQ(outcome(0.014, 0.9), Outcome::kPassed);
  EXPECT_EQ(outcome(0.018, 0.9), Outcome::kCare);
  EXPECT_EQ(outcome(0.022, 0.9), Outcome::kFailed);
  EXPECT_EQ(outcome(0.022, 0.1), Outcome::kPassed);
}

TEST(VehicleJudgement, FindsAModelThatIsSystematicallyOffOnTheHoldOut) {
  using estimation::Outcome;
  const auto with = [](double rmse_there, double lag1_there, double lag1_here) {
    Case c;
    c.fit.quantities = {yaw_rate(0.99, 0.01, lag1_here)};
    c.validation.quantities = {yaw_rate(0.98, rmse_there, lag1_there)};
    return c.judge();
  };
  const auto outcome = [&](double rmse_there, double lag1_there, double lag1_here) {
    return judged_row(with(rmse_there, lag1_there, lag1_here), "residual on the hold-out").outcome;
  };
  EXPECT_EQ(outcome(0.014, 0.5, 0.5), Outcome::kPassed) << "as it was where it was identified";
  EXPECT_EQ(outcome(0.02, 0.1, 0.1), Outcome::kPassed) << "larger, but white";
  EXPECT_EQ(outcome(0.02, 0.5, 0.5), Outcome::kCare);
  EXPECT_EQ(outcome(0.011, 0.5, 0.1), Outcome::kCare);
  const VehicleJudgement found = with(0.02, 0.5, 0.5);
  EXPECT_EQ(found.judgement.prediction.grade, estimation::Grade::kWithCare);
  EXPECT_EQ(found.judgement.parameters.grade, estimation::Grade::kYes);
}

/// Both methods with standard errors of 1 %, output error's C_f being `ratio` times equation error's.
AgreementChecks agreement_where_c_f_differs(double ratio, DriveTyre tyre = kDriveTyre<LinearTyre>) {
  Case c;
  c.options.model.tyre = tyre;
  EquationErrorEstimates equation_error;
  AxleEstimate axle;
  axle.method = estimation::Method::kGtls;
  axle.usable = true;
  axle.value = {6e4, 6e4, 1800.0};
  axle.covariance.diagonal() = (0.01 * axle.value).cwiseAbs2();
  axle.consistency_p = 0.3;
  equation_error.regression.axles = {axle};
  OutputErrorResult output_error;
  output_error.estimate.usable = true;
  output_error.raw.covariance = axle.covariance;
  for (const auto& [name, value] : {std::pair{"C_f", ratio * 6e4}, {"C_r", 6e4}, {"I_z", 1800.0}})
    output_error.estimate.parameters.push_back({.name = name, .value = value});
  return check_agreement({c.signals, c.segments, c.start, c.signal_options, c.options},
                         {.chosen = c.estimate,
                          .equation_error = &equation_error,
                          .output_error = &output_error,
                          .fit = c.fit,
                          .validation = c.validation,
                          .by_noise = c.by_noise});
}

TEST(CheckAgreement, ComparesTheMethodsWithinTheirErrorBars) {
  using estimation::Outcome;
  const AgreementChecks same = agreement_where_c_f_differs(1.02);
  ASSERT_TRUE(same.methods && same.consistency);
  EXPECT_EQ(same.methods->outcome, Outcome::kPassed) << same.methods->text;
  EXPECT_EQ(same.consistency->outcome, Outcome::kPassed) << same.consistency->text;
  // 20 % by errors of 1, 1 and, for the small angles, 1 %: 11 standard deviations.
  const AgreementChecks other = agreement_where_c_f_differs(1.2);
  EXPECT_EQ(other.methods->outcome, Outcome::kFailed) << other.methods->text;
  EXPECT_TRUE(other.methods->bears_on.contains(estimation::Purpose::kParameters));
  EXPECT_FALSE(other.methods->bears_on.contains(estimation::Purpose::kPrediction));
  EXPECT_EQ(agreement_where_c_f_differs(1.2, kDriveTyre<SimpleMagicFormulaTyre>).methods->outcome, Outcome::kCare);
}

TEST(VehicleJudgement, HasARowForEveryCheckOfASoundEstimate) {
  std::vector<std::string> names;
  for (const estimation::Evidence& row : Case().judge().checks) names.push_back(row.name);
  EXPECT_THAT(names, ElementsAre("residual beyond the sensors", "unmodelled share", "simulation", "plausibility of C_f",
                                 "plausibility of C_r", "hold-out", "residual on the hold-out"));
}

}  // namespace
}  // namespace veridyn::vehicle
