#include "veridyn/camera/fusion/inertial_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::camera {
namespace {

using Model = InertialModel;

/// Free of gravity by hand: on a bank of 10 deg, right side down, at rest, f = g in track axes seen from the body.
TEST(InertialModel, TakesGravityOutOfTheSpecificForce) {
  Model::State<double> x = Model::State<double>::Zero();
  x(Model::kHeading) = 1.0;
  x(Model::kRoll) = 10.0 * kDegree;
  const Eigen::Vector3d rest(0.0, kGravity * std::sin(x(Model::kRoll)), kGravity * std::cos(x(Model::kRoll)));
  EXPECT_LT(Model::acceleration<double>(x, rest).norm(), 1e-12);
  x(Model::kAccelBias) = 0.3;
  EXPECT_NEAR(Model::acceleration<double>(x, rest + Eigen::Vector3d(0.3, 0.0, 0.0)).norm(), 0.0, 1e-12);
}

TEST(InertialModel, TransitionIsThatOfDifferences) {
  Model model;
  Model::State<double> x;
  x << 1.0, 2.0, 1.5, -0.4, 0.7, 0.05, -0.03, 0.01, -0.02, 0.015, 0.1, -0.05, 0.02, 0.03;
  const Model::Input u{{0.2, -0.3, 1.8}, {1.2, -2.0, 9.6}};
  Model::State<double> after;
  const auto F = estimation::transition(model, x, u, 0.01, after);
  for (int k = 0; k < Model::kStates; ++k) {
    const double h = 1e-5;
    Model::State<double> up = x, down = x;
    up(k) += h;
    down(k) -= h;
    const Eigen::Matrix<double, Model::kDynamic, 1> slope =
        ((model.propagate<double>(up, u, 0.01) - model.propagate<double>(down, u, 0.01)) / (2.0 * h)).head<7>();
    EXPECT_LT((slope - F.col(k)).norm(), 1e-8) << k;
  }
}

/// A circle at constant rate has a closed form; the error of a second is of second order in the step.
TEST(InertialModel, FollowsACircleToSecondOrder) {
  const double rate = 2.0, speed = 1.5;
  const auto error = [&](int steps) {
    Model model;
    Model::State<double> x = Model::State<double>::Zero();
    x(Model::kVelocity) = speed;
    const Model::Input u{{0.0, 0.0, rate}, {0.0, speed * rate, kGravity}};
    for (int k = 0; k < steps; ++k) x = model.propagate<double>(x, u, 1.0 / steps);
    const double r = speed / rate;
    return (x.head<2>() - Eigen::Vector2d(r * std::sin(rate), r * (1.0 - std::cos(rate)))).norm();
  };
  EXPECT_LT(error(100), 1e-4);
  EXPECT_NEAR(error(100) / error(200), 4.0, 0.2);
}

TEST(InertialModel, NoiseGrowsWithTimeHoweverItIsCut) {
  Model model;
  const auto after = [&](int steps) {
    Eigen::Matrix<double, Model::kStates, Model::kStates> P;
    P.setZero();
    const Model::State<double> x = Model::State<double>::Zero();
    const Model::Input u{{0.0, 0.0, 1.0}, {0.0, 0.0, kGravity}};
    for (int k = 0; k < steps; ++k) model.add_process_noise(x, u, 1.0 / steps, P);
    return P;
  };
  const auto one = after(1), many = after(50);
  for (int i = Model::kVelocity; i < Model::kStates; ++i) EXPECT_NEAR(one(i, i), many(i, i), 1e-12) << i;
}

}  // namespace
}  // namespace veridyn::camera
