#include "veridyn/vehicle/identification/vehicle_prediction.hpp"

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
  const auto of = [&](DriveUnknown u) { return theta(u); };
  EXPECT_NEAR(of(DriveUnknown::kSteerBias), 0.004, 1e-5);
  EXPECT_NEAR(of(DriveUnknown::kYawRateBias), -0.006, 1e-5);
  EXPECT_NEAR(of(DriveUnknown::kAccelYBias), 0.15, 1e-4);
  EXPECT_EQ(of(DriveUnknown::kCf), p.C_f);
  EXPECT_EQ(of(DriveUnknown::kA), p.a);
}

TEST(IdentifiedVehicle, TakesWhatIsDeterminedAndKeepsTheWheelbase) {
  using estimation::ParameterStatus;
  const VehicleParameters<double> start = family_car();
  const DriveSignals signals;
  const DriveSegments segments;
  const DriveSignalOptions signal_options;
  VehicleIdentifyOptions options;
  const VehicleProblem problem{signals, segments, start, signal_options, options};
  VehicleEstimate estimate;
  estimate.parameters = {{.name = "C_f", .value = 5e4, .status = ParameterStatus::kIdentified},
                         {.name = "C_r", .value = 7e4, .status = ParameterStatus::kNotExcited},
                         {.name = "a", .value = 1.3, .status = ParameterStatus::kIdentified},
                         {.name = "mu", .value = 0.8, .status = ParameterStatus::kIdentified}};
  const VehicleParameters<double> linear = identified_vehicle(problem, estimate);
  EXPECT_EQ(linear.C_f, 5e4);
  EXPECT_EQ(linear.C_r, start.C_r);
  EXPECT_EQ(linear.I_z, start.I_z);
  EXPECT_EQ(linear.a, 1.3);
  EXPECT_DOUBLE_EQ(linear.b, 1.4);
  EXPECT_EQ(linear.mu, start.mu) << "linear tyres have no friction";
  options.model.tyre = DriveTyre::kMagicFormula;
  EXPECT_EQ(identified_vehicle(problem, estimate).mu, 0.8);
}

}  // namespace
}  // namespace veridyn::vehicle
