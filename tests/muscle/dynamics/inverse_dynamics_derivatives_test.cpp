#include "veridyn/muscle/dynamics/inverse_dynamics_derivatives.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "tests/muscle/dynamics/model_trees.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"

namespace veridyn::muscle {
namespace {

/// Central differences of the recursive Newton-Euler algorithm itself.
TEST(InverseDynamicsDerivatives, AreThoseOfCentralDifferences) {
  const Model model = load_model("arm").model();
  const Mechanism mechanism(model);
  ASSERT_TRUE(InverseDynamicsDerivatives::available(mechanism));
  const int n = mechanism.coordinates();
  std::vector<int> all(static_cast<std::size_t>(n));
  std::iota(all.begin(), all.end(), 0);
  InverseDynamicsDerivatives derivatives(mechanism, all);
  Dynamics<double> dynamics(mechanism);
  Eigen::VectorXd q(n), qdot(n), qddot(n), plus(n), minus(n), tau(n);
  for (int i = 0; i < n; ++i) {
    q(i) = 0.4 + 0.3 * i;
    qdot(i) = 2.0 - 1.3 * i;
    qddot(i) = -3.0 + 7.0 * i;
  }
  dynamics.set_state(q.data(), qdot.data());
  dynamics.inverse_dynamics(qddot.data(), nullptr, tau.data());
  derivatives.evaluate(dynamics);
  for (const bool speed : {false, true}) {
    const InverseDynamicsDerivatives::Matrix& exact = speed ? derivatives.by_speed() : derivatives.by_value();
    for (int k = 0; k < n; ++k) {
      constexpr double kStep = 1e-5;
      for (const double sign : {1.0, -1.0}) {
        Eigen::VectorXd a = q, b = qdot;
        (speed ? b : a)(k) += sign * kStep;
        dynamics.set_state(a.data(), b.data());
        dynamics.inverse_dynamics(qddot.data(), nullptr, (sign > 0.0 ? plus : minus).data());
      }
      const Eigen::VectorXd central = (plus - minus) / (2.0 * kStep);
      // Rounding over the step leaves some 1e-9 of moments of some 10 N m.
      EXPECT_LT((central - exact.col(k)).cwiseAbs().maxCoeff(), 1e-7) << k << speed;
      EXPECT_GT(central.cwiseAbs().maxCoeff(), 1e-3);
    }
  }
}

}  // namespace
}  // namespace veridyn::muscle
