#include "veridyn/vehicle/identification/evidence/vehicle_agreement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/vehicle/simulated_drive.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/vehicle/identification/vehicle_identification.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::Outcome;
using ::testing::HasSubstr;

TEST(PartsRow, WidensForSmallContradictionsAndRefusesLargeOnes) {
  EXPECT_EQ(parts_row({{.p = 0.4, .ratio = 0.9}, 0.3}, 1e-3).outcome, Outcome::kPassed);
  EXPECT_THAT(says(parts_row({{.p = 0.1, .ratio = 2.25}, 0.01}, 1e-3)), HasSubstr("1.50 times as wide"));
  EXPECT_EQ(parts_row({{.p = 1e-5, .ratio = 9.0}, 0.02}, 1e-3).outcome, Outcome::kCare);
  EXPECT_EQ(parts_row({{.p = 1e-5, .ratio = 9.0}, 0.2}, 1e-3).outcome, Outcome::kFailed);
  EXPECT_EQ(variance_factor(std::nullopt), 1.0);
  EXPECT_EQ(variance_factor(PartsAgreement{{.p = 0.4, .ratio = 0.5}}), 1.0);
}

TEST(Widened, LeavesWhatIsNotKnownOfTheMassAsItIs) {
  VehicleEstimate estimate;
  estimate.degrees_of_freedom = 100.0;
  estimate.parameters = {{.name = "C_f",
                          .value = 100.0,
                          .sigma = 5.0,
                          .low95 = 90.0,
                          .high95 = 110.0,
                          .status = estimation::ParameterStatus::kIdentified}};
  estimate.covariance = Eigen::MatrixXd::Constant(1, 1, 25.0);
  estimate.given_covariance = Eigen::MatrixXd::Constant(1, 1, 16.0);  // 9 are the drive's
  const VehicleEstimate wide = widened(estimate, 4.0, 0.05);
  EXPECT_NEAR(wide.covariance(0, 0), 4.0 * 9.0 + 16.0, 1e-12);
  EXPECT_NEAR(wide.parameters[0].sigma, std::sqrt(52.0), 1e-12);
  EXPECT_NEAR(wide.parameters[0].high95 - 100.0, 10.0 * std::sqrt(52.0 / 25.0), 1e-9);
  EXPECT_EQ(widened(estimate, 0.7, 0.05).covariance(0, 0), 25.0);
}

/// A drive of a minute on whose second half the front tyres are `stiffer`; the halves are estimated separately.
VehicleIdentification of_two_halves(double stiffer) {
  const testing::WanderingSteer steer(2, 0.02);
  const VehicleTrajectory drive = testing::drive_bicycle<BicycleModel<double, LinearTyre<double>>>(
      [&](double t) {
        VehicleParameters<double> p = testing::family_car();
        if (t > 30.0) p.C_f *= stiffer;
        return testing::linear_bicycle(p);
      },
      60.0, [&](double t) { return steer(t); }, [](double) { return 20.0; });
  const DriveSignalOptions signal_options;
  const DriveSignals signals =
      prepare_drive_signals(testing::mapped(record_drive(drive, reference_drive_sensors(), 2)), signal_options);
  DriveSegmentOptions halves;
  halves.identification_spans = {{0.0, 30.0}};
  halves.holdout_spans = {{30.0, 60.0}};
  const DriveSegments segments = find_drive_segments(signals, halves);
  Progress silent;
  return identify_parameters({signals, segments, testing::family_car(), signal_options, {}}, silent);
}

const estimation::Evidence& parts_of(const VehicleIdentification& id) {
  const auto row = std::ranges::find(id.checks, estimation::Check::kPartsOfDrive, &estimation::Evidence::check);
  EXPECT_NE(row, id.checks.end());
  return *row;
}

TEST(CompareParts, WidensTheIntervalsOfACarThatChangesALittle) {
  const VehicleIdentification same = of_two_halves(1.0), changed = of_two_halves(1.05), other = of_two_halves(1.3);
  ASSERT_EQ(same.chosen, VehicleMethod::kOutputError);
  EXPECT_EQ(parts_of(same).outcome, Outcome::kPassed) << says(parts_of(same));
  EXPECT_EQ(parts_of(changed).outcome, Outcome::kCare) << says(parts_of(changed));
  EXPECT_EQ(parts_of(other).outcome, Outcome::kFailed) << says(parts_of(other));
  const estimation::Parameter *narrow = same.best()->find("C_f"), *wide = changed.best()->find("C_f");
  EXPECT_GT(wide->sigma, 2.0 * narrow->sigma);
  // What both halves are lies inside the interval then.
  EXPECT_LE(wide->low95, 55000.0);
  EXPECT_GE(wide->high95, 1.05 * 55000.0);
  EXPECT_EQ(other.verdict, estimation::GroupVerdict::kEffective) << other.reason;
}

}  // namespace
}  // namespace veridyn::vehicle
