#include "veridyn/estimation/output_error/parametric_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimation/output_error/example_models.hpp"

namespace veridyn::estimation {
namespace {

using namespace testing_support;

TEST(ParametricModel, SensitivitiesAreThoseOfTheClosedForm) {
  // u = 0: x = x0 exp(-a t), so dx/da = -t x, dx/dx0 = exp(-a t), dx/db = 0; rate = -a x.
  const FirstOrder model({VectorXd::Zero(50)}, 0.05);
  const std::vector<Index> active{2, 0, 1};
  ModelResponse r;
  ASSERT_TRUE(model.respond(0, Eigen::Vector3d(kA, kB, 0.8), active, r));
  for (Index k = 0; k < 50; ++k) {
    const double t = 0.05 * static_cast<double>(k), x = 0.8 * std::exp(-kA * t);
    EXPECT_NEAR(r.output(k, 0), x, 1e-13);
    EXPECT_NEAR(r.sensitivity(2 * k, 0), std::exp(-kA * t), 1e-13);
    EXPECT_NEAR(r.sensitivity(2 * k, 1), -t * x, 1e-13);
    EXPECT_NEAR(r.sensitivity(2 * k, 2), 0.0, 1e-15);
    EXPECT_NEAR(r.sensitivity(2 * k + 1, 1), -x + kA * t * x, 1e-13);
  }
}

TEST(ParametricModel, SensitivitiesAreThoseOfCentralDifferences) {
  const FirstOrder model(doublets(1, 80), 0.05);
  const VectorXd theta = Eigen::Vector3d(kA, kB, 0.4);
  const std::vector<Index> active{0, 1, 2};
  ModelResponse r, low, high;
  ASSERT_TRUE(model.respond(0, theta, active, r));
  for (Index i = 0; i < 3; ++i) {
    const double h = 1e-5;  // error of the differences: h^2 f'''/6 and 1e-16/h, both about 1e-10
    ASSERT_TRUE(model.respond(0, theta + h * VectorXd::Unit(3, i), {}, high));
    ASSERT_TRUE(model.respond(0, theta - h * VectorXd::Unit(3, i), {}, low));
    const RowMatrix difference = (high.output - low.output) / (2.0 * h);
    for (Index k = 0; k < difference.size(); ++k) EXPECT_NEAR(r.sensitivity(k, i), difference.data()[k], 1e-9);
  }
}

}  // namespace
}  // namespace veridyn::estimation
