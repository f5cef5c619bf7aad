#include "veridyn/vehicle/identification/validation/drive_validation.hpp"

#include <gtest/gtest.h>

#include "tests/vehicle/simulated_drive.hpp"

namespace veridyn::vehicle {
namespace {

using testing::family_car;
using testing::lively_drive;
using testing::mapped;

/// All that a drive without errors of the sensors needs.
DriveTheta exact_theta(const VehicleParameters<double>& p) {
  DriveTheta theta{Eigen::VectorXd::Zero(kDriveUnknowns)};
  theta.value.head(4) << p.C_f, p.C_r, p.I_z, p.a;
  return theta;
}

TEST(DriveValidation, PredictsTheDriveOfAKnownVehicleAndItsPath) {
  const VehicleParameters<double> p = family_car();
  DriveSensorSet sensors = testing::perfect_sensors();
  sensors[DriveSensorKind::kPosition] = {.enabled = true, .rate_Hz = 100.0};
  const DriveSignals signals = prepare_drive_signals(mapped(record_drive(lively_drive(p, 7), sensors, 1)), {});
  const std::vector<TimeSpan> spans{{10.0, 20.0}, {30.0, 40.0}};
  Progress silent;
  const DriveValidation v = predict_drive(signals, spans, p, {}, exact_theta(p), silent);
  ASSERT_NE(v.find("yaw_rate"), nullptr);
  EXPECT_GT(v.find("yaw_rate")->fit.r2, 1.0 - 1e-9);
  EXPECT_GT(v.find("accel_y")->fit.r2, 1.0 - 1e-9);
  ASSERT_NE(v.find("path"), nullptr);
  // 200 m of path; trapezoids at 10 ms.
  EXPECT_LT(v.find("path")->fit.rmse, 0.05);
}

}  // namespace
}  // namespace veridyn::vehicle
