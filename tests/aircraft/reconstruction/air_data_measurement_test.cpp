#include "veridyn/aircraft/reconstruction/air_data_measurement.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/aircraft/simulated_flight.hpp"

namespace veridyn::aircraft::internal {
namespace {

/// 20 m/s forward and 2 m/s down through still air, nose level, heading 3 rad.
AirDataState<double> descending() {
  AirDataState<double> x;
  x.attitude = numerics::quaternion_from_euler(0.1, 0.0, 3.0);
  x.velocity = x.attitude * Eigen::Vector3d(20.0, 1.0, 2.0);
  return x;
}

std::optional<OfferedSample> offered(Sensor which, double z, const MeasurementContext& context = {}) {
  return offered_sample(AirDataMotion{}, nullptr, descending(), context, which, z, 0.5);
}

TEST(OfferedSample, IsTheReadingLessWhatTheStateSays) {
  const double square = 20.0 * 20.0 + 1.0 + 4.0;
  EXPECT_NEAR(offered(kRoll, 0.3)->nu, 0.2, 1e-12);
  EXPECT_NEAR(offered(kVelEast, 7.0)->nu, 7.0 - descending().velocity.y(), 1e-12);
  MeasurementContext context;
  context.air_density = 1.1;
  EXPECT_NEAR(offered(kPitot, 300.0, context)->nu, 300.0 - 0.5 * 1.1 * square, 1e-9);
  context.pitot_is_pressure = false;
  EXPECT_NEAR(offered(kPitot, 25.0, context)->nu, 25.0 - std::sqrt(square), 1e-12);
  EXPECT_NEAR(offered(kAlpha, 0.2)->nu, 0.2 - std::atan2(2.0, 20.0), 1e-12);
  EXPECT_NEAR(offered(kBeta, 0.2)->nu, 0.2 - std::asin(1.0 / std::sqrt(square)), 1e-12);
  context.beta_is_flank = true;
  EXPECT_NEAR(offered(kBeta, 0.2, context)->nu, 0.2 - std::atan2(1.0, 20.0), 1e-12);
  EXPECT_EQ(offered(kAlpha, 0.2)->variance, 0.25);
}

// Heading 3 rad read as -3.1 rad is 0.183 rad further round.
TEST(OfferedSample, ComparesAnglesTheShortWayRound) { EXPECT_NEAR(offered(kYaw, -3.1)->nu, 2.0 * kPi - 6.1, 1e-12); }

// Pitching up at 2 rad/s about the centre of gravity moves a vane 0.5 m in front of it upwards at 1 m/s, in air that
// then comes from below the less: w = 2 - 1.
TEST(OfferedSample, MovesTheVaneWithTheBody) {
  MeasurementContext context;
  context.gyro = Eigen::Vector3d(0.0, 2.0, 0.0);
  context.vane_position = Eigen::Vector3d(0.5, 0.0, 0.0);
  EXPECT_NEAR(offered(kAlpha, 0.0, context)->nu, -std::atan2(1.0, 20.0), 1e-12);
}

TEST(OfferedSample, IsNoneWhereTheSensorSaysNothing) {
  MeasurementContext slow;
  slow.min_airspeed = 25.0;
  EXPECT_FALSE(offered(kAlpha, 0.0, slow));
  EXPECT_FALSE(offered(kBeta, 0.0, slow));
  EXPECT_TRUE(offered(kPitot, 0.0, slow)) << "a tube reads at any speed";
  EXPECT_FALSE(offered(kAccelX, 0.0)) << "without a force model the accelerometer drives the filter";
}

// The specific force that the model itself gives leaves no innovation, and the gyro's noise widens its variance.
TEST(OfferedSample, OfTheAccelerometerIsTheModelsForce) {
  const Subject subject = aircraft::testing::linear_unatrap();
  ModelBasedMotion motion;
  motion.subject = &subject;
  MeasurementContext context;
  context.gyro = Eigen::Vector3d(0.1, 0.2, 0.3);
  context.gyro_sigma = 0.01;
  AirDataInput u;
  u.gyro = context.gyro;
  u.air_density = context.air_density;
  const AirDataState<double> x = descending();
  const Eigen::Vector3d force = motion.specific_force(motion.air_velocity(x), context.gyro, Eigen::Vector3d::Zero(), u);
  for (const int axis : {0, 1, 2}) {
    const auto which = static_cast<Sensor>(kAccelX + axis);
    const auto sample = offered_sample(motion, &motion, x, context, which, force(axis) + 0.25, 0.5);
    ASSERT_TRUE(sample);
    EXPECT_NEAR(sample->nu, 0.25, 1e-9) << axis;
    EXPECT_GE(sample->variance, 0.25) << axis;
  }
  const auto lift = offered_sample(motion, &motion, x, context, kAccelZ, 0.0, 0.5);
  EXPECT_GT(lift->variance, 0.25) << "lift depends on the pitch rate";
}

}  // namespace
}  // namespace veridyn::aircraft::internal
