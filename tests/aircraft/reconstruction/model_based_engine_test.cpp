#include <gtest/gtest.h>

#include "tests/aircraft/reconstruction/filter_engines.hpp"
#include "tests/aircraft/simulated_flight.hpp"

namespace veridyn::aircraft::internal {
namespace {

TEST(ModelBasedEngine, MovesByTheForcesThatItIsGiven) {
  const auto engine = model_based_engine(false);
  EXPECT_TRUE(engine->has_forces());
  const Subject subject = aircraft::testing::linear_unatrap();
  ModelBasedMotion motion;
  motion.subject = &subject;
  const Start start = aircraft::testing::level_start();
  const auto filter = engine->estimator(motion, start);
  const AirDataInput u = aircraft::testing::level_input();
  const Eigen::Vector3d force = motion.specific_force(motion.air_velocity(start.x), u.gyro, Eigen::Vector3d::Zero(), u);
  constexpr double kStep = 1e-4;
  filter->propagate(u, kStep);
  const Eigen::Vector3d rate = (filter->state().velocity - start.x.velocity) / kStep;
  // Level: body axes are those of the ground. Of the first order in the step.
  EXPECT_LT((rate - force - Eigen::Vector3d(0.0, 0.0, kGravity)).norm(), 1e-2);
  EXPECT_GT(rate.norm(), 0.1) << "this is no equilibrium";
}

TEST(ModelBasedEngine, StartsAgainFromAModelFreeFilter) {
  const Subject subject = aircraft::testing::linear_unatrap();
  ModelBasedMotion motion;
  motion.subject = &subject;
  motion.error.initial = {0.02, 0.03, 0.04};
  for (const bool imu_errors : {false, true}) {
    const auto free = model_free_engine(imu_errors)->estimator(motion, aircraft::testing::level_start());
    for (int i = 0; i < 10; ++i) free->propagate(aircraft::testing::level_input(), 0.01);
    const auto based = model_based_engine(imu_errors)->estimator(motion, aircraft::testing::level_start());
    based->restart_from(*free);
    const CovarianceView from = free->covariance(), to = based->covariance();
    const Eigen::Index n = from.matrix.rows();
    EXPECT_EQ(to.matrix.topLeftCorner(n, n), from.matrix);
    EXPECT_EQ(to.matrix.topRightCorner(n, 3), Eigen::MatrixXd::Zero(n, 3)) << "errors of the model are another matter";
    for (int i = 0; i < 3; ++i)
      EXPECT_DOUBLE_EQ(
          to.matrix(to.coefficient_error + i, to.coefficient_error + i),
          motion.error.sigma(static_cast<std::size_t>(i)) * motion.error.sigma(static_cast<std::size_t>(i)));
    EXPECT_EQ(based->state().velocity, free->state().velocity);
    EXPECT_EQ(to.imu_error, from.imu_error);
  }
}

// Forces of another model from now on.
TEST(ModelBasedEngine, TakesAnotherModel) {
  const Subject subject = aircraft::testing::linear_unatrap();
  Subject twice = subject;
  for (double& value : twice.model.find(Coefficient::kCL)->values) value *= 2.0;
  ModelBasedMotion motion;
  motion.subject = &subject;
  const auto plain = model_based_engine(false)->estimator(motion, aircraft::testing::level_start());
  const auto other = model_based_engine(false)->estimator(motion, aircraft::testing::level_start());
  other->set_forces(&twice, motion.error);
  for (const auto* filter : {&plain, &other}) (*filter)->propagate(aircraft::testing::level_input(), 0.1);
  EXPECT_LT(other->state().velocity.z(), plain->state().velocity.z()) << "twice the lift";
}

// The accelerometer's axes are measurements of this filter.
TEST(ModelBasedEngine, SeesTheAccelerometerToo) {
  const aircraft::testing::Flown flown = aircraft::testing::fly({.duration = 3.0});
  const ReconstructOptions o = aircraft::testing::reference_options();
  const ModelStreams with_model = load_model_streams(flown.measured, flown.subject, load_streams(flown.measured, o));
  ModelBasedMotion motion;
  motion.subject = &with_model.force_model;
  const aircraft::testing::SeenSamples samples =
      aircraft::testing::seen_samples(*model_based_engine(false), with_model.streams, o, motion);
  EXPECT_EQ(samples.seen, samples.recorded);
  const aircraft::testing::SeenSamples free =
      aircraft::testing::seen_samples(*model_free_engine(false), load_streams(flown.measured, o), o, {});
  EXPECT_NEAR(static_cast<double>(samples.recorded - free.recorded), 3.0 * 300.0, 10.0);
}

}  // namespace
}  // namespace veridyn::aircraft::internal
