#include "veridyn/numerics/linear_algebra/matrix_exponential.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::numerics {
namespace {

TEST(MatrixExponential, HasItsClosedForms) {
  // A rotation, a shear, and a decay that needs squaring.
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  m(0, 1) = -0.7;
  m(1, 0) = 0.7;
  m(2, 2) = -40.0;
  const Eigen::MatrixXd e = matrix_exponential(Eigen::MatrixXd(m));
  EXPECT_NEAR(e(0, 0), std::cos(0.7), 1e-15);
  EXPECT_NEAR(e(0, 1), -std::sin(0.7), 1e-15);
  EXPECT_NEAR(e(2, 2) / std::exp(-40.0), 1.0, 1e-12);
  Eigen::MatrixXd shear = Eigen::MatrixXd::Zero(3, 3);
  shear(0, 1) = shear(1, 2) = 2.0;
  const Eigen::MatrixXd s = matrix_exponential(shear);
  EXPECT_NEAR(s(0, 2), 2.0, 1e-15);
  EXPECT_NEAR(s(0, 1), 2.0, 1e-15);
}

TEST(MatrixExponential, OfTheNegativeIsTheInverse) {
  std::srand(3);
  const Eigen::MatrixXd m = 2.0 * Eigen::MatrixXd::Random(7, 7);
  EXPECT_LT((matrix_exponential(m) * matrix_exponential(Eigen::MatrixXd(-m)) - Eigen::MatrixXd::Identity(7, 7)).norm(),
            1e-11);
  EXPECT_EQ(matrix_exponential(SmallMatrix(m)), matrix_exponential(m));
}

}  // namespace
}  // namespace veridyn::numerics
