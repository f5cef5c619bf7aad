#include "veridyn/estimation/output_error/information.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/estimation/output_error/example_models.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing_support::FirstOrder;

std::vector<VectorXd> random_inputs(int segments) {
  std::mt19937_64 engine(4);
  std::normal_distribution<double> normal;
  std::vector<VectorXd> u;
  for (int s = 0; s < segments; ++s) {
    u.emplace_back(60);
    for (double& value : u.back()) value = normal(engine);
  }
  return u;
}

// What an estimate of three segments says of its intervals, from two of them and what the third would add.
TEST(Information, OfAFurtherSegmentPredictsTheCovarianceWithIt) {
  const std::vector<VectorXd> u = random_inputs(3);
  FirstOrder all(u, 0.1), two({u[0], u[1]}, 0.1), third({u[2]}, 0.1);
  for (FirstOrder* model : {&all, &two, &third}) model->unknowns[1].prior_sigma = 0.01;
  OutputErrorOptions o;
  o.noise = OutputNoise::kGiven;
  o.noise_start = Eigen::Vector2d(0.05, 0.2);
  o.max_steps = 0;
  o.max_relaxations = 1;
  for (const bool free_starts : {true, false}) {
    o.free_initial_conditions = free_starts;
    const auto covariance = [&](const FirstOrder& model) {
      const std::vector<RowMatrix> z(model.segments(), RowMatrix::Ones(60, 2));
      return output_error(model, z, o).covariance_white;
    };
    const std::optional<RowMatrix> root = information_root(third, o);
    ASSERT_TRUE(root.has_value());
    const MatrixXd expected = covariance(all), found = covariance_after(covariance(two), *root);
    EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-9 * expected.diagonal().maxCoeff());
    EXPECT_LT(found(0, 0), 0.9 * covariance(two)(0, 0));
  }
}

TEST(Information, LeavesWhatIsKnownAndSaysWhenASimulationDiverges) {
  FirstOrder model(random_inputs(1), 0.1);
  OutputErrorOptions o;
  o.noise_start = Eigen::Vector2d(0.05, 0.2);
  const std::optional<RowMatrix> root = information_root(model, o);
  ASSERT_TRUE(root.has_value());
  MatrixXd P = MatrixXd::Zero(2, 2);
  P(1, 1) = 1e6;
  const MatrixXd after = covariance_after(P, *root);
  EXPECT_EQ(after(0, 0), 0.0);
  const MatrixXd information = root->transpose() * *root;
  EXPECT_NEAR(after(1, 1) * information(1, 1), 1.0, 1e-6);
  model.refuses_growth = true;
  o.search_start = Eigen::Vector2d(-1.0, 1.0);
  EXPECT_FALSE(information_root(model, o).has_value());
  o.noise_start = {};
  EXPECT_THROW(static_cast<void>(information_root(model, o)), InputError);
}

}  // namespace
}  // namespace veridyn::estimation
