#include "veridyn/estimation/open_loop/open_loop_response.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimation/open_loop/decay.hpp"

namespace veridyn::estimation {
namespace {

const Eigen::VectorXd kTheta{{0.3, 2.0}};

TEST(OpenLoopResponse, HasTheDerivativesOfTheClosedForm) {
  const Decay model(std::vector<double>(30, 0.0), 0.3);
  const OpenLoopResponse r = open_loop_response(model, 0, kTheta, Eigen::MatrixXd::Identity(1, 1));
  ASSERT_EQ(r.states.rows(), 30);
  ASSERT_EQ(r.parameters.rows(), 30);
  ASSERT_EQ(r.conditions.cols(), 1);
  for (Eigen::Index k = 0; k < 30; ++k) {
    const double t = Decay::kStep * static_cast<double>(k), decayed = std::exp(-0.3 * t);
    EXPECT_NEAR(r.states(k, 0), 2.0 * decayed, 1e-14);
    EXPECT_NEAR(r.parameters(k, 0), -t * 2.0 * decayed, 1e-13);
    EXPECT_NEAR(r.conditions(k, 0), decayed, 1e-14);
  }
}

TEST(OpenLoopResponse, LeavesOutParametersWithoutVariance) {
  const Decay model(std::vector<double>(5, 0.0), 0.3);
  const OpenLoopResponse r = open_loop_response(model, 0, kTheta, Eigen::MatrixXd::Zero(1, 1));
  EXPECT_TRUE(r.parameters.isZero());
  EXPECT_NEAR(r.conditions(4, 0), std::exp(-0.3 * 0.4), 1e-14);
}

}  // namespace
}  // namespace veridyn::estimation
