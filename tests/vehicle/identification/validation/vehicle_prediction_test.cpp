#include "veridyn/vehicle/identification/validation/vehicle_prediction.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "tests/vehicle/simulated_drive.hpp"

namespace veridyn::vehicle {
namespace {

using testing::family_car;
using testing::lively_drive;
using testing::mapped;

TEST(FitDriveBiases, FindsThoseOfTheDayAndLeavesTheVehicleAlone) {
  const VehicleParameters<double> p = family_car();
  DriveSensorSet sensors = testing::perfect_sensors();
  sensors[DriveSensorKind::kSteer].bias = 0.004;
  sensors[DriveSensorKind::kYawRate].bias = -0.006;
  sensors[DriveSensorKind::kAccelY].bias = 0.15;
  const DriveSignals signals =
      prepare_drive_signals(mapped(record_drive(lively_drive(p, 3, 0.02, 30.0), sensors, 1)), {});
  const std::vector<TimeSpan> spans{{2.0, 28.0}};
  DriveModelOptions options;
  options.prior.fill(std::numeric_limits<double>::infinity());
  // A start that is not the vehicle's is not taken for it.
  options.start[DriveUnknown::kCf] = 1.0;
  Progress silent;
  const Eigen::VectorXd theta = fit_drive_biases(signals, spans, p, options, silent);
  const auto of = [&](DriveUnknown u) { return theta(static_cast<Eigen::Index>(u)); };
  EXPECT_NEAR(of(DriveUnknown::kSteerBias), 0.004, 1e-5);
  EXPECT_NEAR(of(DriveUnknown::kYawRateBias), -0.006, 1e-5);
  EXPECT_NEAR(of(DriveUnknown::kAccelYBias), 0.15, 1e-4);
  EXPECT_EQ(of(DriveUnknown::kCf), p.C_f);
  EXPECT_EQ(of(DriveUnknown::kA), p.a);
}

}  // namespace
}  // namespace veridyn::vehicle
