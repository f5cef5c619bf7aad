#include "veridyn/vehicle/identification/drive_parametric_model.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/vehicle/simulated_drive.hpp"

namespace veridyn::vehicle {
namespace {

using testing::family_car;
using testing::lively_drive;
using testing::mapped;

TEST(DriveParametricModel, SensitivitiesAreThoseOfFiniteDifferences) {
  const VehicleParameters<double> p = family_car();
  for (const DriveTyre tyre : {DriveTyre::kLinear, DriveTyre::kMagicFormula}) {
    DriveSensorSet sensors = testing::perfect_sensors();
    sensors[DriveSensorKind::kLateralVelocity].enabled = true;
    DriveSignals signals = prepare_drive_signals(mapped(record_drive(lively_drive(p, 1, 0.02, 12.0), sensors, 1)), {});
    signals.accel_position = {0.3, -0.2, 0.1};
    DriveModelOptions options;
    options.tyre = tyre;
    options.free.fill(true);
    options.start[DriveUnknown::kYawRateDelay] = 0.013;
    options.start[DriveUnknown::kSteerDelay] = 0.017;
    // At no delay the ends, where nothing lies beyond, have one-sided derivatives.
    options.start[DriveUnknown::kAccelYDelay] = 0.009;
    const std::vector<TimeSpan> spans{{4.0, 8.0}};
    const DriveParametricModel model(signals, spans, p, options);
    Eigen::VectorXd theta(static_cast<Eigen::Index>(kDriveUnknowns) + 2);
    for (std::size_t i = 0; i < kDriveUnknowns; ++i) theta(static_cast<Eigen::Index>(i)) = model.parameters()[i].start;
    for (std::size_t i = 0; i < 2; ++i)
      theta(static_cast<Eigen::Index>(kDriveUnknowns + i)) = model.initial_conditions(0)[i].start;
    std::vector<Eigen::Index> active(static_cast<std::size_t>(theta.size()));
    std::iota(active.begin(), active.end(), Eigen::Index{0});
    estimation::ModelResponse exact, above, below;
    ASSERT_TRUE(model.respond(0, theta, active, exact));
    const Eigen::VectorXd size = theta.cwiseAbs().cwiseMax(0.01);
    for (const Eigen::Index i : active) {
      const double h = 1e-5 * size(i);
      Eigen::VectorXd moved = theta;
      moved(i) += h;
      ASSERT_TRUE(model.respond(0, moved, {}, above));
      moved(i) -= 2.0 * h;
      ASSERT_TRUE(model.respond(0, moved, {}, below));
      const estimation::RowMatrix difference = (above.output - below.output) / (2.0 * h);
      const Eigen::Map<const Eigen::VectorXd> flat(difference.data(), difference.size());
      const double scale = std::max(flat.cwiseAbs().maxCoeff(), 1e-6 / size(i));
      EXPECT_LT((flat - exact.sensitivity.col(i)).cwiseAbs().maxCoeff() / scale, 2e-5)
          << "unknown " << i << " tyre " << static_cast<int>(tyre);
    }
  }
}

}  // namespace
}  // namespace veridyn::vehicle
