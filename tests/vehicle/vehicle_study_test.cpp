#include "veridyn/vehicle/vehicle_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "tests/support/channel_faults.hpp"
#include "tests/vehicle/simulated_drive.hpp"
#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::vehicle {
namespace {

using testing::family_car;
using testing::lively_drive;

TEST(VehicleStudy, IdentifiesARecordingThatItIsGiven) {
  const Study study = Study::parse(
      "seed = 3\n[subject]\nkind = \"vehicle\"\nname = \"car\"\nmass = 1500\na = 1.2\nb = 1.5\n[identify]\nmethod = "
      "\"output error\"\n[identify.uncertainty]\nmass = \"15 kg\"\n",
      "study.toml");
  Progress silent;
  VehicleStudy read =
      vehicle::read_study(study, record_drive(lively_drive(family_car(), 1), reference_drive_sensors(), 1), silent);
  study.root().finish();
  EXPECT_EQ(read.identify.given.mass, 15.0);
  EXPECT_EQ(read.vehicle.I_z, 1500.0 * 1.2 * 1.5);
  VehicleAnalysis analysis = identify(read, silent);
  const estimation::Parameter* C_f = analysis.estimate.find("C_f");
  ASSERT_NE(C_f, nullptr);
  EXPECT_LE(C_f->low95, 55000.0);
  EXPECT_GE(C_f->high95, 55000.0);
  EXPECT_GT(analysis.estimate.validation.at("yaw_rate").r2, 0.99);
  // On another drive: held-out data.
  VehicleStudy other =
      vehicle::read_study(study, record_drive(lively_drive(family_car(), 9), reference_drive_sensors(), 9), silent);
  const VehicleAnalysis validated = validate(other, analysis.estimate, silent);
  EXPECT_EQ(validated.identification.verdict, estimation::GroupVerdict::kIdentified) << validated.identification.reason;
  EXPECT_GT(validated.estimate.validation.at("yaw_rate").r2, 0.99);
}

/// An estimate with these values of C_f, C_r and I_z, whose parameters have these statuses.
estimation::Estimate given_values(const std::array<double, 3>& values,
                                  const std::array<estimation::ParameterStatus, 3>& status) {
  estimation::Estimate estimate;
  estimate.method = "output error";
  estimate.covariance = Eigen::MatrixXd::Zero(3, 3);
  for (std::size_t i = 0; i < 3; ++i) {
    estimate.parameters.push_back({.name = std::array{"C_f", "C_r", "I_z"}[i],
                                   .value = values[i],
                                   .sigma = 0.01 * values[i],
                                   .status = status[i]});
    estimate.covariance(i, i) = 1e-4 * values[i] * values[i];
  }
  return estimate;
}

VehicleAnalysis validated_on_a_drive(const estimation::Estimate& estimate) {
  Progress silent;
  static const VehicleStudy drive = vehicle::read_study(
      Study::parse("seed = 3\n[subject]\nkind = \"vehicle\"\nmass = 1500\na = 1.2\nb = 1.5\n", "study.toml"),
      record_drive(lively_drive(family_car(), 9, 0.02, 30.0), reference_drive_sensors(), 9), silent);
  return validate(drive, estimate, silent);
}

using Status = estimation::ParameterStatus;
constexpr std::array kAllIdentified{Status::kIdentified, Status::kIdentified, Status::kIdentified};

TEST(VehicleStudy, AnotherDriveHoldsForTheSameCarAndNotForAnother) {
  const VehicleParameters<double> p = family_car();
  const VehicleAnalysis same = validated_on_a_drive(given_values({p.C_f, p.C_r, p.I_z}, kAllIdentified));
  const estimation::Evidence& row = same.identification.checks.front();
  EXPECT_EQ(row.check, estimation::Check::kAnotherRecording);
  EXPECT_EQ(row.outcome, estimation::Outcome::kPassed) << says(row);
  EXPECT_EQ(same.estimate.judgement.prediction.grade, estimation::Grade::kYes);
  EXPECT_EQ(same.estimate.judgement.parameters.grade, estimation::Grade::kNotJudged) << "nothing was identified";
  // Front tyres of a tenth of the stiffness hardly turn a car.
  const VehicleAnalysis other = validated_on_a_drive(given_values({0.1 * p.C_f, p.C_r, p.I_z}, kAllIdentified));
  EXPECT_EQ(other.identification.checks.front().outcome, estimation::Outcome::kFailed)
      << says(other.identification.checks.front());
  EXPECT_EQ(other.identification.verdict, estimation::GroupVerdict::kRejected);
  EXPECT_EQ(other.estimate.judgement.prediction.grade, estimation::Grade::kNo);
  EXPECT_THAT(other.identification.reason, ::testing::StartsWith("does not hold"));
}

// The verdict follows from the same rows as the grade: yaw rates are predicted as well as ever, but the drive
// contradicts itself.
TEST(VehicleStudy, ADriveThatContradictsItselfHoldsForNoCar) {
  const VehicleParameters<double> p = family_car();
  Recording recording = record_drive(lively_drive(p, 9, 0.02, 30.0), reference_drive_sensors(), 9);
  test::scaled({"accel_y"}, 0.1)(recording);
  Progress silent;
  const VehicleStudy drive = vehicle::read_study(
      Study::parse("seed = 3\n[subject]\nkind = \"vehicle\"\nmass = 1500\na = 1.2\nb = 1.5\n", "study.toml"), recording,
      silent);
  const VehicleAnalysis analysis = validate(drive, given_values({p.C_f, p.C_r, p.I_z}, kAllIdentified), silent);
  const VehicleIdentification& id = analysis.identification;
  EXPECT_EQ(id.checks.front().outcome, estimation::Outcome::kPassed) << says(id.checks.front());
  EXPECT_EQ(id.judgement.prediction.grade, estimation::Grade::kNo);
  EXPECT_EQ(id.verdict, estimation::GroupVerdict::kRejected);
  EXPECT_THAT(id.reason, ::testing::StartsWith("does not hold"));
  EXPECT_EQ(id.judgement.parameters.grade, estimation::Grade::kNotJudged) << "nothing was identified";
}

// A vehicle is rejected as a whole, but what was not excited or was given keeps that status.
TEST(VehicleStudy, AnEstimateThatWasRejectedNeverHolds) {
  const VehicleParameters<double> p = family_car();
  for (const Status of_inertia : {Status::kRejected, Status::kNotExcited}) {
    const VehicleAnalysis analysis =
        validated_on_a_drive(given_values({p.C_f, p.C_r, p.I_z}, {Status::kRejected, Status::kRejected, of_inertia}));
    const VehicleIdentification& id = analysis.identification;
    EXPECT_EQ(id.verdict, estimation::GroupVerdict::kRejected) << estimation::to_string(of_inertia);
    EXPECT_EQ(id.reason, "does not hold: the estimate was rejected where it was identified");
    EXPECT_EQ(analysis.estimate.judgement.prediction.grade, estimation::Grade::kNo);
  }
}

}  // namespace
}  // namespace veridyn::vehicle
