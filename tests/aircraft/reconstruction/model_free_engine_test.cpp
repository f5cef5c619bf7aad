#include <gtest/gtest.h>

#include "tests/aircraft/reconstruction/filter_engines.hpp"
#include "tests/aircraft/simulated_flight.hpp"

namespace veridyn::aircraft::internal {
namespace {

TEST(ModelFreeEngine, KnowsNoForcesWhateverItIsGiven) {
  const auto engine = model_free_engine(false);
  EXPECT_FALSE(engine->has_forces());
  const Subject subject = aircraft::testing::linear_unatrap();
  const auto plain = engine->estimator({}, aircraft::testing::level_start());
  const auto given = engine->estimator({}, aircraft::testing::level_start());
  given->set_forces(&subject, {});
  for (const auto* filter : {&plain, &given}) (*filter)->propagate(aircraft::testing::level_input(), 0.1);
  EXPECT_EQ(plain->state().velocity, given->state().velocity);
  EXPECT_EQ(plain->covariance().matrix, given->covariance().matrix);
  EXPECT_EQ(plain->covariance().coefficient_error, -1);
}

TEST(ModelFreeEngine, HasErrorsOfTheInertialSensorsWhereItIsAskedFor) {
  const auto without = model_free_engine(false)->estimator({}, aircraft::testing::level_start());
  const auto with = model_free_engine(true)->estimator({}, aircraft::testing::level_start());
  EXPECT_EQ(without->covariance().imu_error, -1);
  EXPECT_EQ(without->covariance().matrix.rows(), AirDataErrorVector::kCore);
  EXPECT_EQ(with->covariance().matrix.rows(), AirDataErrorVector::kCore + AirDataErrorVector::kImuErrors);
  EXPECT_EQ(with->covariance().matrix(with->covariance().imu_error, with->covariance().imu_error), 0.01);
}

// Level flight at constant speed stays so, and knows less of its velocity as time goes on.
TEST(ModelFreeEngine, FliesOnAsItsSensorsSay) {
  const auto filter = model_free_engine(false)->estimator({}, aircraft::testing::level_start());
  const double before = filter->covariance().matrix(AirDataErrorVector::kVelocity, AirDataErrorVector::kVelocity);
  for (int i = 0; i < 100; ++i) filter->propagate(aircraft::testing::level_input(), 0.01);
  EXPECT_LT((filter->state().velocity - Eigen::Vector3d(20.0, 0.0, 0.0)).norm(), 1e-9);
  EXPECT_GT(filter->covariance().matrix(AirDataErrorVector::kVelocity, AirDataErrorVector::kVelocity), before);
}

// A pitot tube that reads 25 m/s moves the airspeed up, not the velocity over ground alone: the wind takes its share.
TEST(ModelFreeEngine, TakesASampleIn) {
  const auto filter = model_free_engine(false)->estimator({}, aircraft::testing::level_start());
  estimation::InnovationMonitor monitor{estimation::InnovationGate{}};
  MeasurementContext context;
  context.pitot_is_pressure = false;
  estimation::Innovation seen;
  EXPECT_TRUE(filter->measure(context, kPitot, 20.2, 0.1, monitor, &seen));
  EXPECT_NEAR(seen.nu, 0.2, 1e-12);
  EXPECT_GT(filter->motion().air_velocity(filter->state()).x(), 20.0);
  EXPECT_LT(filter->state().wind.x(), 0.0);
}

TEST(ModelFreeEngine, SeesEverySampleOfASegmentOnce) {
  const Recording recording = aircraft::testing::make_flight({.duration = 3.0}).recording;
  ReconstructOptions o;
  o.sensors = NoiseSource::kReference;
  const aircraft::testing::SeenSamples samples =
      aircraft::testing::seen_samples(*model_free_engine(false), load_streams(recording, o), o, {});
  EXPECT_GT(samples.recorded, 1500U);
  EXPECT_EQ(samples.seen, samples.recorded);
}

}  // namespace
}  // namespace veridyn::aircraft::internal
