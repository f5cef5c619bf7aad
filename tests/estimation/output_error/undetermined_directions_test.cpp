#include "veridyn/estimation/output_error/undetermined_directions.hpp"

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/estimation/output_error/example_models.hpp"
#include "veridyn/estimation/output_error/output_error.hpp"

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

using namespace testing_support;

/// Two columns that differ by a millionth, and a third: the sum of two parameters is known, their difference is not.
Static valley() {
  RowMatrix X(200, 3);
  for (Index k = 0; k < X.rows(); ++k) {
    const double t = 0.05 * static_cast<double>(k);
    X(k, 0) = std::sin(t);
    X(k, 1) = std::sin(t) + 1e-3 * std::cos(3.0 * t);
    X(k, 2) = std::cos(t);
  }
  Static model({{X}});
  for (ModelParameter& p : model.unknowns) {
    p.start = 1.0;
    p.low = 0.5;
    p.high = 1.5;
  }
  return model;
}

TEST(UndeterminedDirections, HoldsWhatTheDataDoNotDetermine) {
  const Static model = valley();
  std::mt19937_64 generator(8);
  std::normal_distribution<double> noise(0.0, 1e-2);
  RowMatrix z(200, 1);
  ModelResponse response;
  ASSERT_TRUE(model.respond(0, Eigen::Vector3d(1.1, 1.1, 0.9), {}, response));
  for (Index k = 0; k < 200; ++k) z(k, 0) = response.output(k, 0) + noise(generator);
  OutputErrorOptions options{.noise = OutputNoise::kGiven, .noise_start = Eigen::VectorXd::Constant(1, 1e-2)};
  const OutputErrorEstimate wandering = output_error(model, {z}, options);
  options.hold_undetermined = true;
  const OutputErrorEstimate held = output_error(model, {z}, options);
  ASSERT_TRUE(wandering.usable() && held.usable()) << held.message;
  // sigma of the difference is 1e-2/(1e-3 sqrt(100)) = 1 per unit; the bounds allow 0.29 each. Noise drives the search.
  EXPECT_GT(std::abs(wandering.theta(0) - wandering.theta(1)), 0.05);
  // The sum is found, the difference stays where it was; the third parameter is as before.
  EXPECT_NEAR(held.theta(0) + held.theta(1), 2.2, 0.01);
  EXPECT_NEAR(held.theta(0), held.theta(1), 1e-3);
  EXPECT_NEAR(held.theta(2), 0.9, 0.005);
  ASSERT_EQ(held.held.size(), 1u);
  EXPECT_THAT(held.held[0].text, ::testing::AllOf(::testing::HasSubstr("theta0"), ::testing::HasSubstr("theta1")));
  EXPECT_THAT(held.message, ::testing::HasSubstr("stay where the search began"));
  EXPECT_EQ(held.parameters[0].status, ParameterStatus::kNotExcited);
  EXPECT_EQ(held.parameters[2].status, ParameterStatus::kIdentified);
  EXPECT_TRUE(std::isfinite(held.parameters[2].sigma));
}

TEST(UndeterminedDirections, SearchesFromElsewhereAndHoldsAtTheStartAllTheSame) {
  const Static model = valley();
  RowMatrix z(200, 1);
  ModelResponse response;
  ASSERT_TRUE(model.respond(0, Eigen::Vector3d(1.1, 1.1, 0.9), {}, response));
  z = response.output;
  OutputErrorOptions options{
      .noise = OutputNoise::kGiven, .noise_start = Eigen::VectorXd::Constant(1, 1e-2), .hold_undetermined = true};
  const OutputErrorEstimate here = output_error(model, {z}, options);
  options.search_start = Eigen::Vector3d(1.4, 0.8, 1.2);
  const OutputErrorEstimate there = output_error(model, {z}, options);
  ASSERT_TRUE(here.usable() && there.usable()) << there.message;
  EXPECT_LT((here.theta - there.theta).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_EQ(there.held.size(), 1u);
  options.search_start = Eigen::Vector3d(1.4, 0.8, 1e3);
  EXPECT_THROW((void)output_error(model, {z}, options), InputError);
  options.search_start = Eigen::Vector2d(1.4, 0.8);
  EXPECT_THROW((void)output_error(model, {z}, options), InputError);
}

TEST(UndeterminedDirections, HoldsNothingThatTheDataDetermine) {
  Static model = valley();
  RowMatrix z(200, 1);
  ModelResponse response;
  ASSERT_TRUE(model.respond(0, Eigen::Vector3d(1.2, 0.9, 0.9), {}, response));
  z = response.output;
  const OutputErrorEstimate e = output_error(
      model, {z},
      {.noise = OutputNoise::kGiven, .noise_start = Eigen::VectorXd::Constant(1, 1e-6), .hold_undetermined = true});
  ASSERT_TRUE(e.usable()) << e.message;
  EXPECT_TRUE(e.held.empty());
  EXPECT_LT((e.theta - Eigen::Vector3d(1.2, 0.9, 0.9)).cwiseAbs().maxCoeff(), 1e-4);
  model.unknowns[0].high = kInfinity;
  EXPECT_THROW((void)output_error(model, {z}, {.hold_undetermined = true}), InputError);
}

}  // namespace
}  // namespace veridyn::estimation::internal
