#include "veridyn/muscle/identification/null_directions.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::muscle {
namespace {

// Two parameters of which only the sum is known: the covariance in units of the priors has the eigenvalues 1, along
// (1, -1), and 0.01. The third is fixed, the fourth known.
TEST(NullDirections, NameWhatOnlyPriorsHold) {
  const std::vector<estimation::ModelParameter> parameters{{.name = "A", .prior_sigma = 2.0},
                                                           {.name = "B", .prior_sigma = 3.0},
                                                           {.name = "C", .fixed = true},
                                                           {.name = "D", .prior_sigma = 1.0}};
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(4, 4);
  covariance(0, 0) = 0.505 * 4.0;
  covariance(1, 1) = 0.505 * 9.0;
  covariance(0, 1) = covariance(1, 0) = -0.495 * 6.0;
  covariance(3, 3) = 0.01;
  const NullDirections found = null_directions(parameters, covariance, 0.75);
  ASSERT_EQ(found.texts.size(), 1u);
  EXPECT_TRUE(found.texts[0] == "A against B" || found.texts[0] == "B against A") << found.texts[0];
  ASSERT_EQ(found.vectors.rows(), 4);
  EXPECT_NEAR(std::abs(found.vectors(0, 0)), std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(found.vectors(1, 0), -found.vectors(0, 0), 1e-12);
  EXPECT_EQ(found.vectors(2, 0), 0.0);
  covariance(3, 3) = std::nan("");
  EXPECT_TRUE(null_directions(parameters, covariance, 0.75).texts.empty());
}

}  // namespace
}  // namespace veridyn::muscle
