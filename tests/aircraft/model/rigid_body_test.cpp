#include "veridyn/aircraft/model/rigid_body.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/ode.hpp"

namespace veridyn::aircraft {
namespace {

using Eigen::Vector3d;
using State = RigidBodyState<double>;

State tumbling() {
  State x = State::Zero();
  x(9) = 1.0;
  x.tail<3>() = Vector3d(2.0, -1.0, 3.0);
  x.segment<3>(3) = Vector3d(10, 3, -20);
  return x;
}

const MassProperties kBody(2.0, Inertia{0.8, 1.1, 1.7, 0.12}.matrix());

State fly_free(double duration, int steps) {
  State x = tumbling();
  const double h = duration / steps;
  const auto rate = [](double, const State& s) {
    return rigid_body_rate<double>(s, kBody, Vector3d::Zero(), Vector3d::Zero(), kGravity);
  };
  for (int i = 0; i < steps; ++i) {
    x = numerics::runge_kutta_4_step(rate, i * h, x, h);
    normalise_attitude(x);
  }
  return x;
}

TEST(RigidBody, KeepsAngularMomentumAndEnergyWithoutTorque) {
  const State a = tumbling(), b = fly_free(10.0, 4000);
  const auto momentum = [](const State& x) -> Vector3d {
    return attitude_of(x).toRotationMatrix() * (kBody.inertia * x.tail<3>());
  };
  const auto energy = [](const State& x) { return 0.5 * x.tail<3>().dot(kBody.inertia * x.tail<3>()); };
  // RK4 at 2.5 ms: relative error of order (omega h)^4 omega T = (0.01)^4 * 40 = 4e-7 at most; measured 1e-10.
  EXPECT_LT((momentum(a) - momentum(b)).norm() / momentum(a).norm(), 1e-8);
  EXPECT_NEAR(energy(b) / energy(a), 1.0, 1e-9);
}

TEST(RigidBody, FallsOnAParabola) {
  const State b = fly_free(3.0, 100);
  EXPECT_NEAR(b(0), 30.0, 1e-11);
  EXPECT_NEAR(b(1), 9.0, 1e-11);
  EXPECT_NEAR(b(2), -60.0 + 0.5 * kGravity * 9.0, 1e-11);
}

TEST(RigidBody, ConvergesWithTheFourthPowerOfTheStep) {
  const State exact = fly_free(2.0, 16000);
  const double coarse = (fly_free(2.0, 100) - exact).tail<7>().norm();
  const double fine = (fly_free(2.0, 200) - exact).tail<7>().norm();
  EXPECT_NEAR(std::log2(coarse / fine), 4.0, 0.25);
}

}  // namespace
}  // namespace veridyn::aircraft
