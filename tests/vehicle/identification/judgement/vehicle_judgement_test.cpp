#include "veridyn/vehicle/identification/judgement/vehicle_judgement.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Check;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

estimation::PredictedQuantity yaw_rate(double r2, double rmse, double lag1 = 0.0) {
  estimation::PredictedQuantity q{.name = "yaw_rate", .unit = "rad/s", .fit = {}, .lag1 = lag1};
  q.fit.r2 = r2;
  q.fit.rmse = rmse;
  q.fit.count = 1000;
  return q;
}

std::vector<Check> not_passed(const VehicleJudgement& judgement) {
  std::vector<Check> checks;
  for (const estimation::Evidence& row : judgement.checks)
    if (!row.passed()) checks.push_back(row.check);
  return checks;
}

estimation::Evidence judged_row(const VehicleJudgement& judgement, Check check) {
  const auto row = std::ranges::find(judgement.checks, check, &estimation::Evidence::check);
  if (row == judgement.checks.end()) throw std::logic_error("no row " + std::string(to_string(check)));
  return *row;
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
  EXPECT_EQ(c.judge().judgement.prediction.grade, estimation::Grade::kWithCare);
  c.validation.quantities = {yaw_rate(0.2, 0.011)};
  const VehicleJudgement found = c.judge();
  EXPECT_EQ(found.verdict, estimation::GroupVerdict::kRejected);
  EXPECT_THAT(not_passed(found), ElementsAre(Check::kHoldOut));
}

// A car whose body rolls: predicted well by a bicycle whose values make up for the rolling.
TEST(VehicleJudgement, MotionThatTheBicycleDoesNotHaveLeavesThePredictionOnly) {
  Case c;
  c.fit.quantities = {yaw_rate(0.7, 0.2, 0.9)};
  const VehicleJudgement found = c.judge();
  EXPECT_EQ(found.verdict, estimation::GroupVerdict::kEffective);
  EXPECT_THAT(found.reason, HasSubstr("its values are no physical constants"));
  EXPECT_THAT(not_passed(found), ElementsAre(Check::kAutocorrelatedResidual, Check::kUnmodelledShare));
  EXPECT_NEAR(judged_row(found, Check::kUnmodelledShare).value, 0.3, 0.005);
  EXPECT_EQ(found.judgement.parameters.grade, estimation::Grade::kNo);
  EXPECT_EQ(found.judgement.prediction.grade, estimation::Grade::kYes);
}

TEST(VehicleJudgement, StiffnessThatNoTyreHasIsNoPhysicalConstant) {
  Case c;
  c.estimate.parameters[0].value = 6e6;
  const VehicleJudgement found = c.judge();
  EXPECT_EQ(found.verdict, estimation::GroupVerdict::kEffective);
  EXPECT_THAT(not_passed(found), ElementsAre(Check::kPlausibleStiffness));
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
  EXPECT_THAT(not_passed(c.judge()), ElementsAre(Check::kHoldOut));
  EXPECT_EQ(c.judge().judgement.prediction.grade, estimation::Grade::kNotJudged);
  c.fit.quantities.clear();
  EXPECT_EQ(c.judge().verdict, estimation::GroupVerdict::kRejected);
  EXPECT_THAT(not_passed(c.judge()), ElementsAre(Check::kSimulation, Check::kHoldOut));
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
  EXPECT_THAT(not_passed(judge_vehicle(problem, findings)), ElementsAre(Check::kConsistencyEquation));
  // Equation error knows linear tyres only.
  c.options.model.tyre = kDriveTyre<SimpleMagicFormulaTyre>;
  EXPECT_EQ(judge_vehicle(problem, findings).verdict, estimation::GroupVerdict::kIdentified);
}

// Noise is known to a factor of two: up to there an autocorrelated residual needs care, and a white one is noise.
TEST(VehicleJudgement, GradesAResidualByItsSizeAndItsAutocorrelation) {
  using estimation::Outcome;
  const auto outcome = [](double rmse, double lag1) {
    Case c;
    c.fit.quantities = {yaw_rate(0.99, rmse, lag1)};
    c.validation.quantities = {yaw_rate(0.98, rmse, lag1)};
    return judged_row(c.judge(), Check::kAutocorrelatedResidual).outcome;
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
    return judged_row(with(rmse_there, lag1_there, lag1_here), Check::kHoldOutResidual).outcome;
  };
  EXPECT_EQ(outcome(0.014, 0.5, 0.5), Outcome::kPassed) << "as it was where it was identified";
  EXPECT_EQ(outcome(0.02, 0.1, 0.1), Outcome::kPassed) << "larger, but white";
  EXPECT_EQ(outcome(0.02, 0.5, 0.5), Outcome::kCare);
  EXPECT_EQ(outcome(0.011, 0.5, 0.1), Outcome::kCare);
  EXPECT_EQ(outcome(0.01, 0.31, 0.28), Outcome::kPassed) << "no other than where it was identified";
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
  EXPECT_EQ(same.methods->outcome, Outcome::kPassed) << says(*same.methods);
  EXPECT_EQ(same.consistency->outcome, Outcome::kPassed) << says(*same.consistency);
  // 20 % by errors of 1, 1 and, for the small angles, 1 %: 11 standard deviations.
  const AgreementChecks other = agreement_where_c_f_differs(1.2);
  EXPECT_EQ(other.methods->outcome, Outcome::kFailed) << says(*other.methods);
  EXPECT_TRUE(other.methods->bears_on.contains(estimation::Purpose::kParameters));
  EXPECT_FALSE(other.methods->bears_on.contains(estimation::Purpose::kPrediction));
  EXPECT_EQ(agreement_where_c_f_differs(1.2, kDriveTyre<SimpleMagicFormulaTyre>).methods->outcome, Outcome::kCare);
}

TEST(VehicleJudgement, HasARowForEveryCheckOfASoundEstimate) {
  std::vector<Check> checks;
  for (const estimation::Evidence& row : Case().judge().checks) checks.push_back(row.check);
  EXPECT_THAT(checks, ElementsAre(Check::kAutocorrelatedResidual, Check::kUnmodelledShare, Check::kSimulation,
                                  Check::kPlausibleStiffness, Check::kPlausibleStiffness, Check::kHoldOut,
                                  Check::kHoldOutResidual));
}

// Verdict and reason follow from all rows, of what else was done with the estimate too.
TEST(VehicleJudgement, AModelThatDivergesOpenLoopDoesNotPredict) {
  Case c;
  c.estimate.parameters[0].value = 6e6;
  EXPECT_EQ(c.judge().verdict, estimation::GroupVerdict::kEffective);
  const std::vector<estimation::Evidence> diverged{estimation::row_of(Check::kOpenLoopDivergence, "", 3.0)
                                                       .with("windows", 8.0)
                                                       .with("range", std::string("50 rad/s"))};
  const VehicleJudgement found = judge_vehicle(
      {c.signals, c.segments, c.start, c.signal_options, c.options},
      {.chosen = c.estimate, .fit = c.fit, .validation = c.validation, .by_noise = c.by_noise, .further = diverged});
  EXPECT_EQ(found.verdict, estimation::GroupVerdict::kRejected);
  EXPECT_EQ(found.judgement.prediction.grade, estimation::Grade::kNo);
}

// A simulator's gyro has a noise of 2e-8 rad/s: the share of the signal that is not modelled decides, not that noise.
TEST(VehicleJudgement, ANoiseFreeDriveIsJudgedByTheShareThatIsNotModelled) {
  for (const auto& [r2, outcome] : {std::pair{0.9999, estimation::Outcome::kPassed},
                                    {0.92, estimation::Outcome::kPassed},
                                    {0.8, estimation::Outcome::kFailed}}) {
    Case c;
    c.signals.grid = {.begin = 0.0, .step = 0.01, .count = 200};
    for (const DriveSignal signal : {DriveSignal::kSteer, DriveSignal::kYawRate}) {
      c.signals[signal].sigma = 2e-8;
      for (int k = 0; k < 200; ++k) c.signals[signal].value.push_back(0.1 * std::sin(0.1 * k));
    }
    c.segments.identification = {{0.0, 1.9}};
    c.fit.quantities = {yaw_rate(r2, 0.1 * std::sqrt(1.0 - r2), 0.99)};
    const VehicleJudgement found = c.judge();
    const estimation::Evidence residual = judged_row(found, Check::kAutocorrelatedResidual);
    EXPECT_EQ(residual.outcome, estimation::Outcome::kNotVerified) << r2;
    EXPECT_EQ(residual.cause, estimation::Cause::kNoise) << r2;
    EXPECT_EQ(judged_row(found, Check::kUnmodelledShare).outcome, outcome) << r2;
    EXPECT_NEAR(judged_row(found, Check::kUnmodelledShare).value, 1.0 - r2, 1e-9) << r2;
  }
}

}  // namespace
}  // namespace veridyn::vehicle
