// Fitted paths at a pose.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/muscle/path/fit.hpp"
#include "veridyn/muscle/model/simulation_jet.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/path/path_workspace.hpp"

namespace veridyn::muscle {
namespace {

using test::Fit;

TEST(FittedPaths, MomentArmsAreTheDerivativesOfTheFittedLengths) {
  const Fit fit(load_model("arm").model());
  using Jet = SimulationJet;
  std::vector<Jet> length(6), gradient(fit.fitted.pairs().size());
  for (const double a : {-0.5, 0.2, 0.9}) {
    for (const double b : {0.1, 1.0, 2.0}) {
      const Jet q[2] = {Jet(a, 0), Jet(b, 1)};
      fit.fitted.evaluate(q, length.data(), gradient.data());
      std::vector<Eigen::Vector2d> left(6);
      for (std::size_t m = 0; m < 6; ++m) left[m] = length[m].v.head<2>();
      for (std::size_t k = 0; k < gradient.size(); ++k) {
        const auto pair = fit.fitted.pairs()[k];
        left[pair.muscle][pair.coordinate] -= gradient[k].a;
      }
      for (const Eigen::Vector2d& rest : left) EXPECT_NEAR(rest.norm(), 0.0, 1e-13);
    }
  }
}

TEST(FittedPaths, SayWhenACoordinateIsOutsideItsRange) {
  const Fit fit(load_model("arm").model());
  std::vector<double> length(6), gradient(fit.fitted.pairs().size());
  Eigen::VectorXd q = fit.model.default_pose();
  EXPECT_TRUE(fit.fitted.evaluate(q.data(), length.data(), gradient.data()));
  q[1] = fit.model.coordinates[1].high + 0.1;
  EXPECT_FALSE(fit.fitted.evaluate(q.data(), length.data(), gradient.data()));
  for (const double l : length) EXPECT_TRUE(std::isfinite(l));
}

/// Where a fit is not good enough, mixed paths are the exact ones.
TEST(FittedPaths, AreExactWhereNoFitIsGoodEnough) {
  PathFitOptions options;
  options.mixed = true;
  const Fit plain(load_model("arm").model());
  const Fit mixed(load_model("arm").model(), options);
  options.tolerance = 1e-14;
  options.max_degree = 3;
  const Fit strict(load_model("arm").model(), options);
  int fitted = 0;
  for (std::size_t m = 0; m < 6; ++m) {
    EXPECT_TRUE(mixed.fitted.errors()[m].fitted) << m;
    EXPECT_FALSE(strict.fitted.errors()[m].fitted) << m;
    if (mixed.fitted.errors()[m].fitted) ++fitted;
  }
  EXPECT_GT(fitted, 0);
  Kinematics<double> kinematics(mixed.mechanism);
  PathWorkspace<double> exact(mixed.exact), workspace(mixed.exact);
  std::vector<double> length(6), gradient(mixed.fitted.pairs().size());
  std::vector<double> fit_length(6), fit_gradient(plain.fitted.pairs().size());
  std::vector<double> strict_length(6), strict_gradient(strict.fitted.pairs().size());
  ASSERT_EQ(strict_gradient.size(), mixed.exact.pairs().size());
  for (const double b : {0.1, 1.0, 2.0}) {
    const double q[2] = {0.3, b};
    update_positions(mixed.mechanism, q, kinematics);
    mixed.exact.evaluate(kinematics, q, exact);
    EXPECT_TRUE(mixed.fitted.evaluate(mixed.exact, kinematics, q, workspace, length.data(), gradient.data()));
    EXPECT_TRUE(
        strict.fitted.evaluate(strict.exact, kinematics, q, workspace, strict_length.data(), strict_gradient.data()));
    plain.fitted.evaluate(q, fit_length.data(), fit_gradient.data());
    for (std::size_t m = 0; m < 6; ++m) {
      EXPECT_EQ(length[m], mixed.fitted.errors()[m].fitted ? fit_length[m] : exact.length[m]) << m;
      EXPECT_EQ(strict_length[m], exact.length[m]) << m;
    }
    for (std::size_t k = 0; k < strict_gradient.size(); ++k) EXPECT_EQ(strict_gradient[k], exact.gradient[k]) << k;
    for (std::size_t k = 0; k < gradient.size(); ++k) {
      const MusclePaths::Pair pair = mixed.fitted.pairs()[k];
      for (std::size_t j = 0; j < exact.gradient.size(); ++j) {
        if (mixed.exact.pairs()[j].muscle == pair.muscle && mixed.exact.pairs()[j].coordinate == pair.coordinate) {
          EXPECT_NEAR(gradient[k], exact.gradient[j], 3e-3) << k;
        }
      }
    }
  }
}

}  // namespace
}  // namespace veridyn::muscle
