#include "veridyn/muscle/dynamics/inverse_dynamics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/muscle/dynamics/model_trees.hpp"

namespace veridyn::muscle {
namespace {

// One rod on a pin, by hand: (I + m l^2) qddot + m g l sin q.
TEST(InverseDynamics, IsThatOfAPendulum) {
  const Model model = test::pendulum(1);
  const Mechanism mechanism(model);
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.7), qdot = Eigen::VectorXd::Constant(1, -2.0),
                        qddot = Eigen::VectorXd::Constant(1, 3.0);
  const double expected = (0.02 + 1.0 * 0.25 * 0.25) * 3.0 + 1.0 * 9.80665 * 0.25 * std::sin(0.7);
  EXPECT_NEAR(inverse_dynamics(mechanism, q, qdot, qddot)(0), expected, 1e-14);
}

// Two rods: the textbook's double pendulum in relative angles.
TEST(InverseDynamics, IsThatOfADoublePendulum) {
  const Model model = test::pendulum(2);
  const Mechanism mechanism(model);
  const double m1 = 1.0, m2 = 1.5, I = 0.02, l = 0.5, c = 0.25, g = 9.80665;
  const double a = 0.4, b = -0.9, da = 1.3, db = -0.6, dda = 2.0, ddb = -4.0;
  const double M11 = 2.0 * I + m1 * c * c + m2 * (l * l + c * c + 2.0 * l * c * std::cos(b));
  const double M12 = I + m2 * (c * c + l * c * std::cos(b)), M22 = I + m2 * c * c;
  const double h = -m2 * l * c * std::sin(b);
  const double t1 = M11 * dda + M12 * ddb + h * (2.0 * da * db + db * db) + (m1 * c + m2 * l) * g * std::sin(a) +
                    m2 * c * g * std::sin(a + b);
  const double t2 = M12 * dda + M22 * ddb - h * da * da + m2 * c * g * std::sin(a + b);
  const Eigen::VectorXd tau =
      inverse_dynamics(mechanism, Eigen::VectorXd(Eigen::Vector2d(a, b)), Eigen::VectorXd(Eigen::Vector2d(da, db)),
                       Eigen::VectorXd(Eigen::Vector2d(dda, ddb)));
  EXPECT_NEAR(tau(0), t1, 1e-13);
  EXPECT_NEAR(tau(1), t2, 1e-13);
}

}  // namespace
}  // namespace veridyn::muscle
