#include "veridyn/vehicle/identification/fit/drive_parametric_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "tests/vehicle/simulated_drive.hpp"
#include "veridyn/core/index.hpp"

namespace veridyn::vehicle {
namespace {

using testing::family_car;
using testing::lively_drive;
using testing::mapped;

constexpr auto index_of(DriveUnknown u) { return static_cast<Eigen::Index>(u); }

/// A drive of 12 s with the lateral velocity, and a body of which roll and its rate are recorded: what they are does
/// not matter to the model's outputs.
DriveSignals rolling_signals(const DriveSensorSet& like) {
  DriveSensorSet sensors = like;
  sensors[DriveSensorKind::kLateralVelocity].enabled = true;
  DriveSignals signals =
      prepare_drive_signals(mapped(record_drive(lively_drive(family_car(), 1, 0.02, 12.0), sensors, 1)), {});
  signals.accel_position = {0.3, -0.2, 0.1};
  for (const DriveSignal s : {DriveSignal::kRoll, DriveSignal::kRollRate}) {
    signals[s].value = signals[DriveSignal::kYawRate].value;
    signals[s].sigma = 0.003;
  }
  return signals;
}

/// Where a search begins, but off it where that is zero, and off steady cornering.
Eigen::VectorXd theta_of(const DriveParametricModel& model, std::size_t segment = 0) {
  const auto initial = model.initial_conditions(segment);
  Eigen::VectorXd theta(kDriveUnknowns + initial.size());
  for (std::size_t i = 0; i < kDriveUnknowns; ++i) theta(i) = model.parameters()[i].start;
  for (std::size_t i = 0; i < initial.size(); ++i)
    theta(kDriveUnknowns + i) = initial[i].start + (i < 2 ? 0.0 : 0.004 * static_cast<double>(i));
  return theta;
}

estimation::RowMatrix output_of(const DriveParametricModel& model, const Eigen::VectorXd& theta) {
  estimation::ModelResponse response;
  EXPECT_TRUE(model.respond(0, theta, {}, response));
  return response.output;
}

void expect_derivatives(const DriveParametricModel& model, const Eigen::VectorXd& theta,
                        const std::vector<Eigen::Index>& active, const std::string& what) {
  estimation::ModelResponse exact;
  ASSERT_TRUE(model.respond(0, theta, active, exact));
  const Eigen::VectorXd size = theta.cwiseAbs().cwiseMax(0.01);
  for (std::size_t column = 0; column < active.size(); ++column) {
    const Eigen::Index i = active[column];
    const double h = 1e-5 * size(i);
    Eigen::VectorXd moved = theta;
    moved(i) += h;
    const estimation::RowMatrix above = output_of(model, moved);
    moved(i) -= 2.0 * h;
    const estimation::RowMatrix difference = (above - output_of(model, moved)) / (2.0 * h);
    const Eigen::Map<const Eigen::VectorXd> flat(difference.data(), difference.size());
    const double scale = std::max(flat.cwiseAbs().maxCoeff(), 1e-6 / size(i));
    EXPECT_LT((flat - exact.sensitivity.col(column)).cwiseAbs().maxCoeff() / scale, 2e-5)
        << "unknown " << i << ", " << what;
  }
}

TEST(DriveParametricModel, SensitivitiesAreThoseOfFiniteDifferences) {
  const DriveSignals signals = rolling_signals(testing::perfect_sensors());
  for (const DriveTyre tyre : {kDriveTyre<LinearTyre>, kDriveTyre<SimpleMagicFormulaTyre>}) {
    for (const DriveStructure structure :
         {DriveStructure::kBicycle, DriveStructure::kRoll, DriveStructure::kRelaxation}) {
      DriveModelOptions options;
      options.tyre = tyre;
      options.structure = structure;
      options.free.fill(true);
      options.start[DriveUnknown::kYawRateDelay] = 0.013;
      options.start[DriveUnknown::kSteerDelay] = 0.017;
      // At no delay the ends, where nothing lies beyond, have one-sided derivatives.
      options.start[DriveUnknown::kAccelYDelay] = 0.009;
      const std::vector<TimeSpan> spans{{4.0, 8.0}};
      const DriveParametricModel model(signals, spans, family_car(), options);
      const Eigen::VectorXd theta = theta_of(model);
      ASSERT_EQ(theta.size(), signed_index(kDriveUnknowns) + (structure == DriveStructure::kBicycle ? 2
                                                              : has_relaxation(structure)           ? 6
                                                                                                    : 4));
      std::vector<Eigen::Index> active(static_cast<std::size_t>(theta.size()));
      std::iota(active.begin(), active.end(), Eigen::Index{0});
      expect_derivatives(model, theta, active,
                         std::string(to_string(structure)) + ", tyre " + std::to_string(tyre.index()));
    }
  }
}

// Against ten drives: how far the outputs are from those of exact steering, and the mean autocovariance of that over
// the next five samples, within a tenth.
TEST(DriveParametricModel, KnowsWhatNoiseOfTheSteeringDoesToItsOutputs) {
  DriveSensorSet sensors = reference_drive_sensors();
  for (DriveSensor& sensor : sensors.sensors) sensor.bias_sigma = 0.0;
  DriveSensorSet exact = sensors;
  exact[DriveSensorKind::kSteer].sigma = 0.0;
  const VehicleTrajectory drive = lively_drive(family_car(), 1, 0.02, 44.0);
  const std::vector<TimeSpan> spans{{4.0, 40.0}};
  const auto outputs = [&](const DriveSensorSet& recorded_by, std::uint64_t seed, Eigen::MatrixXd& output) {
    const DriveSignals signals = prepare_drive_signals(mapped(record_drive(drive, recorded_by, seed)), {});
    const DriveParametricModel model(signals, spans, family_car(), {});
    const Eigen::MatrixXd all = output_of(model, theta_of(model));
    output = all.bottomRows(all.rows() - 200);  // without the transient of where it begins
    return model.steering_noise(theta_of(model));
  };
  Eigen::MatrixXd without, with;
  EXPECT_EQ(outputs(exact, 1, without).variance.norm(), 0.0);
  // The band that the steering is low-passed to is another one of each drive.
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(2), later = variance, known_variance = variance, known_later = later;
  constexpr int kDrives = 10;
  for (int i = 0; i < kDrives; ++i) {
    const estimation::InputNoise known = outputs(sensors, static_cast<std::uint64_t>(i), with);
    known_variance += known.variance / kDrives;
    known_later += known.autocovariance / kDrives;
    EXPECT_GT(known.memory.minCoeff(), 5.0);
    const Eigen::MatrixXd moved = with - without;
    const Eigen::Index n = moved.rows() - estimation::kColourLags;
    for (Eigen::Index j = 0; j < 2; ++j) {
      const auto count = static_cast<double>(n * kDrives);
      variance(j) += moved.col(j).head(n).squaredNorm() / count;
      for (Eigen::Index lag = 1; lag <= estimation::kColourLags; ++lag)
        later(j) += moved.col(j).head(n).dot(moved.col(j).segment(lag, n)) / count / estimation::kColourLags;
    }
  }
  for (Eigen::Index j = 0; j < 2; ++j) {
    EXPECT_NEAR(variance(j) / known_variance(j), 1.0, 0.1) << j;
    EXPECT_NEAR(later(j) / known_later(j), 1.0, 0.1) << j;
  }
}

TEST(DriveParametricModel, HasNoNoiseOfTheSteeringWhereItIsExactOrSmoothed) {
  const std::vector<TimeSpan> spans{{4.0, 8.0}};
  const auto effect = [&](const DriveSignals& signals, const DriveModelOptions& options) {
    const DriveParametricModel model(signals, spans, family_car(), options);
    return model.steering_noise(theta_of(model)).variance.maxCoeff();
  };
  const DriveSignals noisy = rolling_signals(reference_drive_sensors());
  EXPECT_GT(effect(noisy, {}), 0.0);
  DriveModelOptions smoothed;
  smoothed.smoothing_Hz = 4.0;
  EXPECT_EQ(effect(noisy, smoothed), 0.0);
  DriveSignals exact_steering = noisy;
  exact_steering[DriveSignal::kSteer].sigma = 0.0;
  EXPECT_EQ(effect(exact_steering, {}), 0.0);
}

// An accelerometer on a body that leans by phi shows g phi more; with gravity taken off by a measured roll it does not,
// and one that was divided by 1 + g gradient shows that share of it.
TEST(DriveParametricModel, AccelerometersOfLeaningBodiesFeelGravity) {
  DriveSignals signals = rolling_signals(testing::perfect_sensors());
  const auto outputs = [&](bool gravity_removed, double gradient) {
    signals.gravity_removed = gravity_removed;
    signals.roll_gradient = gradient;
    const std::vector<TimeSpan> spans{{4.0, 8.0}};
    DriveModelOptions options = with_structure({}, DriveStructure::kRoll);
    options.start[DriveUnknown::kRollGradient] = 0.008;
    const DriveParametricModel model(signals, spans, family_car(), options);
    EXPECT_EQ(model.outputs()[1].name, "accel_y");
    EXPECT_EQ(model.outputs()[3].name, "roll");
    return output_of(model, theta_of(model));
  };
  const estimation::RowMatrix felt = outputs(false, 0.0), removed = outputs(true, 0.0), divided = outputs(true, 0.01);
  const Eigen::VectorXd roll = felt.col(3);
  ASSERT_GT(roll.cwiseAbs().maxCoeff(), 0.01);
  EXPECT_LT((felt.col(1) - removed.col(1) - kGravity * roll).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_LT((divided.col(1) * (1.0 + 0.01 * kGravity) - felt.col(1)).cwiseAbs().maxCoeff(), 1e-13);
}

// At x, y, z of the centre of gravity a body that turns and rolls moves by x r' - y r^2 - z phi'' more. Rates from
// differences of the model's own outputs over 20 ms: of motions below 2 Hz they are right to (2 pi 2 Hz 10 ms)^2/6.
TEST(DriveParametricModel, AccelerometersElsewhereMoveWithTheBody) {
  DriveSignals signals = rolling_signals(testing::perfect_sensors());
  const auto outputs = [&](const std::array<double, 3>& position) {
    signals.accel_position = position;
    signals.gravity_removed = true;
    const std::vector<TimeSpan> spans{{4.0, 8.0}};
    const DriveParametricModel model(signals, spans, family_car(), with_structure({}, DriveStructure::kRoll));
    EXPECT_EQ(model.outputs()[4].name, "roll_rate");
    return output_of(model, theta_of(model));
  };
  const estimation::RowMatrix at_centre = outputs({});
  const auto moved = [&](const std::array<double, 3>& position) -> Eigen::VectorXd {
    return (outputs(position) - at_centre).col(1);
  };
  const Eigen::Index inner = at_centre.rows() - 2;
  const auto rate = [&](Eigen::Index column) -> Eigen::VectorXd {
    return (at_centre.col(column).tail(inner) - at_centre.col(column).head(inner)) * (0.5 * signals.grid.rate_Hz());
  };
  const auto expect_equal = [&](const Eigen::VectorXd& found, const Eigen::VectorXd& expected, const char* what) {
    EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 5e-3 * expected.cwiseAbs().maxCoeff()) << what;
  };
  expect_equal(moved({0.4, 0.0, 0.0}).segment(1, inner), 0.4 * rate(0), "ahead");
  expect_equal(moved({0.0, 0.4, 0.0}).segment(1, inner), -0.4 * at_centre.col(0).segment(1, inner).cwiseAbs2(), "left");
  expect_equal(moved({0.0, 0.0, 0.4}).segment(1, inner), -0.4 * rate(4), "above");
}

// The model has nothing of what an accelerometer that is late shows at first, nor of what one that is early shows last.
TEST(DriveParametricModel, WhatADelayMayShowFromOutsideASegmentIsNotCompared) {
  const DriveSignals signals = rolling_signals(testing::perfect_sensors());
  const std::vector<TimeSpan> spans{{4.0, 8.0}};
  DriveModelOptions options;
  options.prior[DriveUnknown::kAccelYDelay] = 0.02;
  const auto measured = [&] { return DriveParametricModel(signals, spans, family_car(), options).measured().front(); };
  const estimation::RowMatrix free = measured();
  const auto edge = std::lround(3.0 * 0.02 * signals.grid.rate_Hz());
  ASSERT_GT(edge, 2);
  EXPECT_TRUE(free.col(0).allFinite());
  EXPECT_TRUE(free.col(1).head(edge).array().isNaN().all() && free.col(1).tail(edge).array().isNaN().all());
  EXPECT_TRUE(free.col(1).segment(edge, free.rows() - 2 * edge).allFinite());
  options.free[DriveUnknown::kAccelYDelay] = false;
  EXPECT_TRUE(measured().allFinite());
}

// The unknowns of a segment's beginning are what its first sample differs from steady cornering by.
TEST(DriveParametricModel, SegmentsBeginOffSteadyCorneringByTheirInitialConditions) {
  const DriveSignals signals = rolling_signals(testing::perfect_sensors());
  const std::vector<TimeSpan> spans{{4.0, 8.0}};
  DriveModelOptions options = with_structure({}, DriveStructure::kRelaxation);
  options.start[DriveUnknown::kRollGradient] = 0.008;
  const DriveParametricModel model(signals, spans, family_car(), options);
  ASSERT_EQ(model.initial_conditions(0).size(), 6U);
  Eigen::VectorXd theta = theta_of(model);
  const auto first = signed_index(kDriveUnknowns);
  theta.tail(4).setZero();
  const Eigen::RowVectorXd steady = output_of(model, theta).row(0);
  EXPECT_EQ(steady(0), theta(first + 1));
  EXPECT_EQ(steady(2), theta(first));
  EXPECT_EQ(steady(4), 0.0);
  theta.segment(first + 2, 2) << 0.012, -0.034;
  const Eigen::RowVectorXd rolled = output_of(model, theta).row(0);
  EXPECT_NEAR(rolled(3) - steady(3), 0.012, 1e-15);
  EXPECT_EQ(rolled(4), -0.034);
  // A front slip of 0.01 rad more is 2 C_f 0.01/m of lateral acceleration; the wheels are hardly turned.
  theta.tail(4) << 0.0, 0.0, 0.01, 0.0;
  const Eigen::RowVectorXd slipped = output_of(model, theta).row(0);
  const VehicleParameters<double> car = family_car();
  const double x = signals.accel_position[0], z = signals.accel_position[2];
  const double force = 2.0 * 0.01 * car.C_f;
  const DriveModelOptions with_starts = with_geometry(options, car, 0.0);
  const double roll_acceleration = std::pow(with_starts.start[DriveUnknown::kRollFrequency], 2) * 0.008 / car.mass;
  const double per_force = 1.0 / car.mass + x * car.a / car.I_z - z * roll_acceleration;
  EXPECT_NEAR(slipped(1) - steady(1), force * per_force, 2e-3 * force * per_force);
}

}  // namespace
}  // namespace veridyn::vehicle
