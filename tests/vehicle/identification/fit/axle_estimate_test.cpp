#include "veridyn/vehicle/identification/fit/axle_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/vehicle/identification/identified_drive.hpp"
#include "veridyn/vehicle/identification/vehicle_identification.hpp"

namespace veridyn::vehicle {
namespace {

using estimation::ParameterStatus;
using testing::drive_bicycle;
using testing::exact_regressions;
using testing::family_car;
using testing::identify;
using testing::lively_drive;
using testing::relative;

TEST(AxleEstimate, OfConsistentCoefficientsIsTheirBicycle) {
  const VehicleParameters<double> p = family_car();
  const DriveRegressionResult result = equation_error(exact_regressions(p), p, {});
  const AxleEstimate* ols = result.find(estimation::Method::kOls);
  ASSERT_TRUE(ols != nullptr && ols->usable) << result.reason;
  EXPECT_NEAR(ols->value(0) / p.C_f, 1.0, 1e-3);
  EXPECT_NEAR(ols->value(1) / p.C_r, 1.0, 1e-3);
  EXPECT_NEAR(ols->value(2) / p.I_z, 1.0, 1e-3);
  EXPECT_GT(ols->consistency_p, 0.5);
}

// Without a moment of inertia that both T and q agree with: the second regression is of another car.
TEST(AxleEstimate, CoefficientsOfNoBicycleContradictEachOther) {
  const VehicleParameters<double> p = family_car();
  DriveRegressions data = exact_regressions(p);
  data.second.regressors.col(1) /= 1.5;  // q = I_z/(2 L C_r) one and a half times as large, T as it was
  const DriveRegressionResult result = equation_error(std::move(data), p, {});
  const AxleEstimate* ols = result.find(estimation::Method::kOls);
  ASSERT_TRUE(ols != nullptr && ols->usable) << result.reason;
  EXPECT_LT(ols->consistency_p, 1e-3);
}

TEST(AxleEstimate, NeedsTenRowsAParameter) {
  const VehicleParameters<double> p = family_car();
  DriveRegressions data = exact_regressions(p);
  const Eigen::Index rows = 10 * (data.first.parameters() + data.second.parameters()) - 1;
  for (estimation::RegressionData* regression : {&data.first, &data.second}) {
    regression->regressors.conservativeResize(rows, Eigen::NoChange);
    regression->regressand.conservativeResize(rows);
    regression->segment.resize(rows);
  }
  const DriveRegressionResult result = equation_error(std::move(data), p, {});
  EXPECT_TRUE(result.axles.empty());
  EXPECT_EQ(result.reason, "69 rows are left within the segments, 70 are needed");
}

TEST(AxleEstimate, EstimatesFromSmallAnglesAreExactToTheSquareOfTheAngle) {
  const VehicleParameters<double> p = family_car();
  double error[2];
  for (const bool half : {false, true}) {
    const VehicleIdentification id =
        identify(lively_drive(p, 1, half ? 0.01 : 0.02), testing::perfect_sensors(), 1, {.output_error = false});
    error[half ? 1 : 0] = relative(id, VehicleMethod::kOls, "C_f", p.C_f);
  }
  EXPECT_NEAR(error[0] / error[1], 4.0, 0.8);
}

TEST(AxleEstimate, RecoversTheTruthWithMeasuredLateralVelocity) {
  const VehicleParameters<double> p = family_car();
  DriveSensorSet sensors = testing::perfect_sensors();
  sensors[DriveSensorKind::kLateralVelocity].enabled = true;
  const VehicleIdentification id = identify(lively_drive(p, 2), sensors, 1);
  ASSERT_TRUE(id.regression && id.regression->data.direct);
  // The direct form takes no small angles; what is left is the interpolation of the recording.
  EXPECT_LT(relative(id, VehicleMethod::kGtls, "C_f", p.C_f), 1e-4);
  EXPECT_LT(relative(id, VehicleMethod::kGtls, "C_r", p.C_r), 1e-4);
  EXPECT_LT(relative(id, VehicleMethod::kGtls, "I_z", p.I_z), 1e-4);
  EXPECT_LT(relative(id, VehicleMethod::kOutputError, "C_f", p.C_f), 1e-6);
}

TEST(AxleEstimate, SteadyCorneringGivesTheUndersteerGradientOnly) {
  const VehicleParameters<double> p = family_car();
  const auto trajectory = drive_bicycle<BicycleModel<double, LinearTyre<double>>>(
      [&](double) { return testing::linear_bicycle(p); }, 60.0, [](double t) { return 5e-4 * t; },
      [](double) { return 20.0; });
  const VehicleIdentification id = identify(trajectory, reference_drive_sensors(), 4, {.output_error = false});
  const AxleEstimate* axle = id.regression->find(estimation::Method::kPcaGtls);
  ASSERT_NE(axle, nullptr);
  EXPECT_LT(std::abs(axle->understeer - understeer_gradient(p)), 3.0 * axle->understeer_sigma);
  EXPECT_LT(axle->understeer_sigma, 0.1 * understeer_gradient(p));
  for (const char* name : {"C_f", "C_r", "I_z"})
    EXPECT_EQ(id.best()->find(name)->status, ParameterStatus::kNotExcited)
        << name << ": " << id.best()->find(name)->sigma;
  EXPECT_EQ(id.best()->find("understeer_gradient")->status, ParameterStatus::kIdentified);
}

}  // namespace
}  // namespace veridyn::vehicle
