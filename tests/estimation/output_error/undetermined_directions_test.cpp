#include "veridyn/estimation/output_error/undetermined_directions.hpp"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <cmath>

namespace veridyn::estimation::internal {
namespace {

/// Three unknowns of different bounds.
struct ThreeUnknowns {
  std::vector<ModelParameter> parameters{{.name = "a", .start = 1.0, .low = 0.0, .high = 2.0},
                                         {.name = "b", .start = -2.0, .low = -10.0, .high = 10.0},
                                         {.name = "c", .start = 0.3, .low = 0.0, .high = 0.5}};
  [[nodiscard]] std::vector<const ModelParameter*> pointers() const {
    return {&parameters[0], &parameters[1], &parameters[2]};
  }
};

// The standard deviation of a uniform distribution over [low, high].
TEST(BoundSigmas, AreThoseOfAUniformDistribution) {
  const ThreeUnknowns u;
  const Eigen::VectorXd sigma = bound_sigmas(u.pointers());
  EXPECT_DOUBLE_EQ(sigma(0), 2.0 / std::sqrt(12.0));
  EXPECT_DOUBLE_EQ(sigma(1), 20.0 / std::sqrt(12.0));
  EXPECT_DOUBLE_EQ(sigma(2), 0.5 / std::sqrt(12.0));
}

// The data know a + 0 b well, say of c less than its bounds do, and nothing of b: the rows hold b and c, and let a
// move.
TEST(UndeterminedRows, AreOrthogonalToWhatTheDataDetermine) {
  const ThreeUnknowns u;
  RowMatrix root = RowMatrix::Zero(2, 3);
  root(0, 0) = 100.0;
  root(1, 2) = 1.0;  // times sigma of c, 0.14: below one
  const RowMatrix rows = undetermined_rows(u.pointers(), root);
  ASSERT_EQ(rows.rows(), 2);
  const Eigen::VectorXd unit = bound_sigmas(u.pointers());
  EXPECT_NEAR((rows * Eigen::Vector3d(1.0, 0.0, 0.0)).norm(), 0.0, 1e-9);
  // As heavy as the best known direction, in units of the bounds.
  const double weight = 100.0 * unit(0);
  EXPECT_NEAR((rows * Eigen::Vector3d(0.0, unit(1), 0.0)).norm(), weight, 1e-9 * weight);
  EXPECT_NEAR((rows * Eigen::Vector3d(0.0, 0.0, unit(2))).norm(), weight, 1e-9 * weight);
}

TEST(UndeterminedRows, AreNoneWhereEverythingIsDetermined) {
  const ThreeUnknowns u;
  EXPECT_EQ(undetermined_rows(u.pointers(), 100.0 * RowMatrix::Identity(3, 3)).rows(), 0);
  EXPECT_EQ(undetermined_rows(u.pointers(), RowMatrix::Zero(1, 3)).rows(), 3) << "of nothing all are held";
}

/// 10 (a + b - 4): data that know the sum only.
class SumCost : public ceres::SizedCostFunction<1, 3> {
 public:
  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    residuals[0] = 10.0 * (x[0][0] + x[0][1] - 4.0);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      jacobians[0][0] = jacobians[0][1] = 10.0;
      jacobians[0][2] = 0.0;
    }
    return true;
  }
};

// The search moves along what the data determine only: the sum becomes 4, and c stays at its start.
TEST(HoldUndetermined, KeepsASearchAtItsStartAlongTheRest) {
  const ThreeUnknowns u;
  Eigen::Vector3d x(1.0, -2.0, 0.3);
  RowMatrix root = RowMatrix::Zero(1, 3);
  root(0, 0) = root(0, 1) = 10.0;
  ceres::Problem problem;
  problem.AddResidualBlock(new SumCost, nullptr, x.data());
  hold_undetermined(problem, x.data(), u.pointers(), root);
  ceres::Solver::Options options;
  options.function_tolerance = 1e-14;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  EXPECT_NEAR(x(0) + x(1), 4.0, 1e-6);
  EXPECT_NEAR(x(2), 0.3, 1e-9);
  // In units of the bounds the change is along (sigma_a, sigma_b): b, known less, moves a hundred times as far.
  EXPECT_NEAR((x(1) + 2.0) / (x(0) - 1.0), 100.0, 1.0);
}

}  // namespace
}  // namespace veridyn::estimation::internal
