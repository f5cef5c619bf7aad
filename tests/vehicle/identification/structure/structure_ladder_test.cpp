#include "veridyn/vehicle/identification/structure/structure_ladder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/vehicle/cars.hpp"
#include "tests/vehicle/simulated_drive.hpp"
#include "tests/vehicle/simulation/drives.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::vehicle {
namespace {

using testing::family_car;
using ::testing::HasSubstr;
using testing::WanderingSteer;

constexpr double kDuration_s = 30.0;

/// The structures of a drive that sensors have recorded, climbed from stiffnesses and an inertia that are wrong.
StructureLadder climbed(const VehicleTrajectory& trajectory, const DriveSensorSet& sensors,
                        VehicleParameters<double> start, const VehicleIdentifyOptions& options = {},
                        Progress&& progress = {}) {
  start.C_f = 80000.0;
  start.C_r = 80000.0;
  start.I_z = 2000.0;
  const DriveSignalOptions signal_options;
  const DriveSignals signals =
      prepare_drive_signals(testing::mapped(record_drive(trajectory, sensors, 1)), signal_options);
  const DriveSegments segments = find_drive_segments(signals, {});
  const VehicleProblem problem{signals, segments, start, signal_options, options};
  if (!signals[DriveSignal::kAccelY].available()) return climb_structures(problem, nullptr, progress);
  const EquationErrorEstimates equation_error = estimate_by_equation_error(problem);
  return climb_structures(problem, &equation_error, progress);
}

VehicleTrajectory bicycle_drive() { return testing::lively_drive(family_car(), 2, 0.02, kDuration_s); }

/// A car on springs and tyres that give way; its loads move, which linear tyres do not notice.
VehicleTrajectory four_wheel_drive() {
  const WanderingSteer steer(3, 0.01, 0.1, 2.0);
  SimulationOptions options;
  options.speed = 20.0;
  options.duration = kDuration_s;
  return testing::drive(
      testing::linear_car(testing::car_with_bars()), [&](double t) { return Controls{.steer = steer(t)}; }, options);
}

double value_of(const StructureLadder& ladder, DriveUnknown unknown) {
  return ladder.fit.raw.theta(static_cast<Eigen::Index>(unknown));
}

TEST(StructureLadder, APlainBicycleStaysOne) {
  const StructureLadder ladder = climbed(bicycle_drive(), reference_drive_sensors(), family_car());
  // To roll; where that is not taken there is nothing to try beyond it.
  ASSERT_EQ(ladder.tried.size(), 3U);
  for (std::size_t i = 0; i < ladder.tried.size(); ++i) {
    EXPECT_EQ(ladder.tried[i].structure, static_cast<DriveStructure>(i));
    EXPECT_TRUE(ladder.tried[i].usable) << ladder.tried[i].message;
    EXPECT_GE(ladder.tried[i].inflation, 1.0);
    EXPECT_TRUE(std::isfinite(ladder.tried[i].holdout_rmse));
  }
  EXPECT_EQ(ladder.chosen, 0U);
  EXPECT_EQ(ladder.reason, "structure: bicycle: none richer makes the drive likelier");
  ASSERT_TRUE(ladder.delay.has_value());
  EXPECT_NEAR(ladder.delay->value_s, 0.0, 2.0 * ladder.delay->sigma_s);
  EXPECT_LT(ladder.delay->sigma_s, 0.003);
  ASSERT_TRUE(ladder.fit.raw.usable()) << ladder.fit.raw.message;
  EXPECT_NEAR(value_of(ladder, DriveUnknown::kCf) / family_car().C_f, 1.0, 0.03);
  // A richer structure contains the simpler one: none is less likely beyond its priors.
  for (std::size_t i = 1; i < ladder.tried.size(); ++i)
    EXPECT_LT(ladder.tried[i].negative_log_likelihood, ladder.tried[0].negative_log_likelihood + 2.0 * kLikelier);
}

// By the truth's own numbers: the sensors are exact, so that what is missed is the model's.
TEST(StructureLadder, ACarThatRollsTakesRollAndItsStiffnessesComeOut) {
  const VehicleParameters<double> car = testing::car_with_bars();
  const StructureLadder ladder = climbed(four_wheel_drive(), testing::perfect_sensors(), car);
  ASSERT_TRUE(ladder.fit.raw.usable()) << ladder.fit.raw.message;
  const TriedStructure& taken = ladder.tried[ladder.chosen];
  EXPECT_TRUE(has_roll(taken.structure)) << to_string(taken.structure);
  EXPECT_THAT(ladder.reason, HasSubstr("structure: roll"));
  EXPECT_THAT(ladder.reason, HasSubstr("likelier than"));
  // The height of the accelerometer, which is unknown too, takes up some of what the wheels' own masses do: 1.1 % of
  // C_f.
  EXPECT_NEAR(value_of(ladder, DriveUnknown::kCf) / car.C_f, 1.0, 0.015);
  EXPECT_NEAR(value_of(ladder, DriveUnknown::kCr) / car.C_r, 1.0, 0.015);
  EXPECT_NEAR(value_of(ladder, DriveUnknown::kIz) / car.I_z, 1.0, 0.015);
  // The roll gradient of springs and bars in series with the tyres, gravity's tilting taken off (m_s c g phi); that the
  // wheels' own masses lean less is not in the model: 2 %.
  const auto corner = [](double spring, double bar, double tyre) {
    return 1.0 / (1.0 / (spring + 2.0 * bar) + 1.0 / tyre);
  };
  const double springs = 0.5 * (car.track_f * car.track_f * corner(car.K_sf, car.K_bf, car.K_tf) +
                                car.track_r * car.track_r * corner(car.K_sr, car.K_br, car.K_tr));
  const double stiffness = springs - (car.mass - 4.0 * car.unsprung_mass) * kGravity * car.cg_height;
  EXPECT_NEAR(value_of(ladder, DriveUnknown::kRollGradient) * stiffness / (car.mass * car.cg_height), 1.0, 0.02);
  // Without it they would not: the bicycle takes gravity in the accelerometer for force.
  EXPECT_GT(std::abs(ladder.tried[0].value[0] / car.C_f - 1.0), 0.02);
  EXPECT_GT(ladder.tried[0].negative_log_likelihood, taken.negative_log_likelihood + kLikelier);
  // The model that may say so finds that the steering is not late.
  ASSERT_TRUE(ladder.delay.has_value());
  EXPECT_NEAR(ladder.delay->value_s, 0.0, 0.01);
}

TEST(StructureLadder, AWrongScaleOfTheAccelerometerIsNoRoll) {
  DriveSensorSet sensors = reference_drive_sensors();
  sensors[DriveSensorKind::kAccelY].scale = 0.09;  // what a body shows that leans by 5 deg/g
  const StructureLadder ladder = climbed(bicycle_drive(), sensors, family_car());
  EXPECT_EQ(ladder.tried[ladder.chosen].structure, DriveStructure::kScaledAccel) << ladder.reason;
  EXPECT_THAT(ladder.reason, HasSubstr("structure: bicycle, accel_y scaled, which makes the drive likelier than "
                                       "bicycle does"));
  ASSERT_TRUE(ladder.fit.raw.usable());
  EXPECT_NEAR(value_of(ladder, DriveUnknown::kAccelYScale), 0.09, 0.01);
  EXPECT_NEAR(value_of(ladder, DriveUnknown::kCf) / family_car().C_f, 1.0, 0.05);
}

// Whatever the drive asks for: this one takes roll where nothing is fixed.
TEST(StructureLadder, TriesOnlyTheStructureThatTheStudyFixes) {
  const VehicleTrajectory trajectory = four_wheel_drive();
  for (const DriveStructure structure : {DriveStructure::kBicycle, DriveStructure::kRoll}) {
    VehicleIdentifyOptions options;
    options.structure = structure;
    const StructureLadder ladder = climbed(trajectory, testing::perfect_sensors(), testing::car_with_bars(), options);
    ASSERT_EQ(ladder.tried.size(), 1U);
    EXPECT_EQ(ladder.tried[0].structure, structure);
    EXPECT_EQ(ladder.chosen, 0U);
    EXPECT_EQ(ladder.reason, "");
    ASSERT_TRUE(ladder.fit.raw.usable()) << ladder.fit.raw.message;
    const auto gradient = static_cast<std::size_t>(DriveUnknown::kRollGradient);
    EXPECT_EQ(ladder.fit.raw.parameters[gradient].sigma > 0.0, has_roll(structure));
  }
}

// Nothing is left that a richer structure could explain.
TEST(StructureLadder, EndsWhereNoMoreIsLeftThanRounding) {
  const StructureLadder ladder = climbed(bicycle_drive(), testing::perfect_sensors(), family_car());
  ASSERT_EQ(ladder.tried.size(), 1U);
  EXPECT_EQ(ladder.tried[0].structure, DriveStructure::kBicycle);
  EXPECT_EQ(ladder.reason, "structure: bicycle: it leaves no more than rounding does");
  EXPECT_NEAR(value_of(ladder, DriveUnknown::kCf) / family_car().C_f, 1.0, 1e-3);
}

// Without an accelerometer there is no scale to try.
TEST(StructureLadder, TriesNoScaleOfAnAccelerometerThatIsMissing) {
  DriveSensorSet sensors = reference_drive_sensors();
  sensors[DriveSensorKind::kAccelY].enabled = false;
  sensors[DriveSensorKind::kLateralVelocity].enabled = true;
  const StructureLadder ladder = climbed(bicycle_drive(), sensors, family_car());
  ASSERT_EQ(ladder.tried.size(), 2U);
  EXPECT_EQ(ladder.tried[1].structure, DriveStructure::kRoll);
  EXPECT_EQ(ladder.chosen, 0U);
}

}  // namespace
}  // namespace veridyn::vehicle
