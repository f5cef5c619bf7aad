#include "veridyn/estimation/output_error/output_error_problem.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimation/output_error/example_models.hpp"
#include "tests/support/refusal.hpp"

namespace veridyn::estimation::internal {
namespace {

using testing_support::doublets;
using testing_support::FirstOrder;
using testing_support::Static;

/// One segment, one output, two parameters: y = X theta, z = y + (0.1, -0.1, ...).
struct StraightLine {
  StraightLine() {
    RowMatrix X(6, 2);
    for (Eigen::Index k = 0; k < 6; ++k) X.row(k) << 1.0, static_cast<double>(k);
    regressors = {{X}};
    RowMatrix z = X * Eigen::Vector2d(2.0, 0.5);
    for (Eigen::Index k = 0; k < 6; ++k) z(k, 0) += k % 2 == 0 ? 0.1 : -0.1;
    measured = {z};
  }
  std::vector<std::vector<RowMatrix>> regressors;
  std::vector<RowMatrix> measured;
};

OutputErrorOptions given_noise() {
  OutputErrorOptions options;
  options.noise = OutputNoise::kGiven;
  options.noise_start = Eigen::VectorXd::Constant(1, 0.2);
  return options;
}

// The triangle [-S | nu] of a whitened segment has the cost, gradient and Gauss-Newton matrix of all its rows.
TEST(OutputErrorProblem, ItsTriangleHasTheNormalEquationsOfTheRows) {
  const StraightLine line;
  const Static model(line.regressors);
  const OutputErrorOptions options = given_noise();
  OutputErrorProblem problem(model, line.measured, options);
  problem.start_noise();
  problem.evaluate(true);
  ASSERT_TRUE(problem.valid());
  const RowMatrix& X = line.regressors[0][0];
  const Eigen::VectorXd nu = line.measured[0] - X * problem.shared();
  const RowMatrix& T = problem.triangle(0).matrix;
  const Eigen::MatrixXd squares = T.transpose() * T;
  EXPECT_LT((squares.topLeftCorner(2, 2) - X.transpose() * X / 0.04).norm(), 1e-9);
  EXPECT_LT((squares.topRightCorner(2, 1) + X.transpose() * nu / 0.04).norm(), 1e-9);
  EXPECT_NEAR(problem.triangle(0).squares, nu.squaredNorm() / 0.04, 1e-9);
  EXPECT_LT((problem.predicted(0) - X * problem.shared()).norm(), 1e-12);
  // The information of the shared unknowns, without any others to eliminate.
  const RowMatrix root = problem.shared_root();
  EXPECT_LT((root.transpose() * root - X.transpose() * X / 0.04).norm(), 1e-9);
}

// A search goes back by a step and weighs by another R: neither is a reason to simulate again.
TEST(OutputErrorProblem, SimulatesNothingTwiceInARow) {
  const StraightLine line;
  const Static model(line.regressors);
  const OutputErrorOptions options;
  OutputErrorProblem problem(model, line.measured, options);
  problem.start_noise();
  problem.evaluate(true);
  const RowMatrix first = problem.triangle(0).matrix;
  const Eigen::Vector2d here = problem.shared();
  problem.shared_block()[0] += 0.5;
  problem.evaluate(true);
  problem.evaluate(false);
  EXPECT_EQ(problem.simulations().with_derivatives, 2U);
  EXPECT_EQ(problem.simulations().values, 0U);
  const double there = problem.triangle(0).squares;
  Eigen::Vector2d::Map(problem.shared_block()) = here;
  problem.evaluate(true);
  EXPECT_EQ(problem.simulations().with_derivatives, 2U);
  EXPECT_EQ(problem.triangle(0).matrix, first);
  EXPECT_NE(problem.triangle(0).squares, there);
  problem.update_noise();
  problem.evaluate(true);
  EXPECT_EQ(problem.simulations().with_derivatives, 2U);
  EXPECT_GT((problem.triangle(0).matrix - first).norm(), 0.1 * first.norm());
  problem.shared_block()[1] += 0.1;
  problem.evaluate(false);
  EXPECT_EQ(problem.simulations().values, 1U);
}

// The truth is (2, 0.5); from a bound above it the cost drives the first unknown beyond, from one below it does not.
TEST(OutputErrorProblem, NamesUnknownsThatTheCostDrivesBeyondABound) {
  const StraightLine line;
  OutputErrorOptions options = given_noise();
  const auto pressed = [&](double low, double high, double start, double prior_sigma) {
    Static model(line.regressors);
    model.unknowns[0] = {.name = "offset", .start = start, .low = low, .high = high, .prior_sigma = prior_sigma};
    model.unknowns[1] = {.name = "slope", .start = 0.5};
    OutputErrorProblem problem(model, line.measured, options);
    problem.start_noise();
    problem.evaluate(true);
    EXPECT_EQ(problem.reaches_bounds(), start == low || start == high);
    return problem.pressed_on_bounds();
  };
  EXPECT_THAT(pressed(2.5, 4.0, 2.5, kInfinity), ::testing::ElementsAre(0));
  EXPECT_THAT(pressed(0.0, 1.5, 1.5, kInfinity), ::testing::ElementsAre(0));
  EXPECT_THAT(pressed(1.5, 4.0, 1.5, kInfinity), ::testing::IsEmpty());
  EXPECT_THAT(pressed(0.0, 2.5, 2.5, kInfinity), ::testing::IsEmpty());
  EXPECT_THAT(pressed(0.0, 4.0, 1.5, kInfinity), ::testing::IsEmpty());
  options.hold_undetermined = true;
  EXPECT_THAT(pressed(2.5, 4.0, 2.5, kInfinity), ::testing::IsEmpty());
}

TEST(OutputErrorProblem, MeasuresChangesInStandardDeviations) {
  const StraightLine line;
  const Static model(line.regressors);
  const OutputErrorOptions options = given_noise();
  OutputErrorProblem problem(model, line.measured, options);
  problem.start_noise();
  problem.evaluate(true);
  Eigen::VectorXd before = problem.shared();
  before(0) -= 0.3;
  // |R^-1/2 X (0.3, 0)| over six rows of noise 0.2.
  EXPECT_NEAR(problem.largest_change_in_sigma(before), 0.3 / 0.2 * std::sqrt(6.0), 1e-9);
  const RowMatrix& X = line.regressors[0][0];
  const double nu2 = (line.measured[0] - X * problem.shared()).squaredNorm();
  EXPECT_NEAR(problem.whitened_residuals()[0].squaredNorm(), nu2 / 0.04, 1e-9);
}

// With an initial condition per segment, its column is eliminated from the information of what all segments share: the
// Schur complement of the whole normal matrix.
TEST(OutputErrorProblem, EliminatesWhatOneSegmentHasAlone) {
  const FirstOrder model(doublets(2, 40), 0.05);
  std::vector<RowMatrix> measured = testing_support::truth_of(model);
  OutputErrorOptions options;
  options.noise = OutputNoise::kGiven;
  options.noise_start = Eigen::VectorXd::Constant(2, 0.1);
  OutputErrorProblem problem(model, measured, options);
  problem.start_noise();
  problem.evaluate(true);
  EXPECT_EQ(problem.segments(), 2U);
  EXPECT_EQ(problem.local_count(0), 1);
  EXPECT_EQ(problem.shared_count(), 2);
  EXPECT_EQ(problem.unknowns(0), 3);
  EXPECT_EQ(problem.all_unknowns(), 4);
  Eigen::Matrix2d expected = Eigen::Matrix2d::Zero();
  for (std::size_t s = 0; s < 2; ++s) {
    const RowMatrix& T = problem.triangle(s).matrix;
    const Eigen::MatrixXd N = T.transpose() * T;
    expected += N.block(1, 1, 2, 2) - N.block(1, 0, 2, 1) * N.block(0, 1, 1, 2) / N(0, 0);
  }
  const RowMatrix root = problem.shared_root();
  EXPECT_LT((root.transpose() * root - expected).norm(), 1e-9 * expected.norm());
}

TEST(OutputErrorProblem, LeavesMissingValuesOut) {
  StraightLine line;
  const Static model(line.regressors);
  const OutputErrorOptions options = given_noise();
  line.measured[0](2, 0) = std::nan("");
  OutputErrorProblem problem(model, line.measured, options);
  problem.start_noise();
  problem.evaluate(true);
  EXPECT_EQ(problem.values(), 5);
  RowMatrix X = line.regressors[0][0];
  X.row(2).setZero();
  const RowMatrix root = problem.shared_root();
  EXPECT_LT((root.transpose() * root - X.transpose() * X / 0.04).norm(), 1e-9);
}

TEST(OutputErrorProblem, RefusesMeasurementsOfAnotherShape) {
  const StraightLine line;
  const Static model(line.regressors);
  const OutputErrorOptions options = given_noise();
  const auto refusal = [&](const std::vector<RowMatrix>& measured) {
    return why([&] { OutputErrorProblem(model, measured, options); });
  };
  EXPECT_NE(refusal({}), "nothing was refused");
  EXPECT_NE(refusal({RowMatrix::Zero(5, 1)}), "nothing was refused");
  EXPECT_NE(refusal({RowMatrix::Zero(6, 2)}), "nothing was refused");
  EXPECT_EQ(refusal(line.measured), "nothing was refused");
}

}  // namespace
}  // namespace veridyn::estimation::internal
