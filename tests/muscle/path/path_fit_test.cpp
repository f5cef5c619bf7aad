#include "veridyn/muscle/path/path_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tests/support/folders.hpp"
#include "veridyn/muscle/model/simulation_jet.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/path/path_workspace.hpp"

namespace veridyn::muscle {
namespace {

struct Fit {
  explicit Fit(Model m, const PathFitOptions& options = {})
      : model(std::move(m)), mechanism(model), exact(model, mechanism), fitted(model, mechanism, exact, options) {}
  Model model;
  Mechanism mechanism;
  MusclePaths exact;
  FittedPaths fitted;
};

/// Lengths of both at random poses that neither the fit nor its check used.
void expect_stated_errors(const Fit& fit) {
  Kinematics<double> kinematics(fit.mechanism);
  PathWorkspace<double> workspace(fit.exact);
  std::vector<double> length(static_cast<std::size_t>(fit.fitted.muscles())), gradient(fit.fitted.pairs().size());
  unsigned seed = 12345;
  const auto uniform = [&] {
    seed = seed * 1664525u + 1013904223u;
    return static_cast<double>(seed >> 8) / 16777216.0;
  };
  for (int i = 0; i < 300; ++i) {
    Eigen::VectorXd q = fit.model.default_pose();
    for (Eigen::Index c = 0; c < q.size(); ++c) {
      const Coordinate& k = fit.model.coordinates[static_cast<std::size_t>(c)];
      q[c] = k.low + (k.high - k.low) * uniform();
    }
    update_positions(fit.mechanism, q.data(), kinematics);
    fit.exact.evaluate(kinematics, q.data(), workspace);
    EXPECT_TRUE(fit.fitted.evaluate(q.data(), length.data(), gradient.data()));
    for (std::size_t m = 0; m < length.size(); ++m)
      EXPECT_NEAR(length[m], workspace.length[m], 3.0 * fit.fitted.errors()[m].length + 1e-9)
          << fit.fitted.errors()[m].muscle;
  }
}

TEST(FittedPaths, OfTheBuiltInArmKeepTheirTolerance) {
  const Fit fit(load_model("arm").model());
  for (const PathFitError& e : fit.fitted.errors()) {
    EXPECT_LT(e.length, 1e-4) << e.muscle;
    // A wrap that begins is a kink of dL/dq: a few poses next to it may be off by more.
    EXPECT_LT(e.above_tolerance, 0.03) << e.muscle;
  }
  expect_stated_errors(fit);
}

TEST(FittedPaths, OfArm26KeepTheirTolerance) {
  const std::filesystem::path file = veridyn::test::shared_folder() / "data/opensim/arm26.osim";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "the OpenSim models of ../shared/data are not here";
  const Fit fit(read_osim(file));
  for (const PathFitError& e : fit.fitted.errors()) {
    EXPECT_LT(e.length, 1e-4) << e.muscle;
    EXPECT_LT(e.above_tolerance, 0.03) << e.muscle;
    if (e.muscle == "BICshort" || e.muscle == "TRIlat" || e.muscle == "TRImed" || e.muscle == "BRA") {
      EXPECT_LT(e.moment_arm, 1e-4) << e.muscle;
    }
  }
  EXPECT_EQ(fit.fitted.pairs().size(), 9u);
  expect_stated_errors(fit);
}

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
        left[static_cast<std::size_t>(pair.muscle)][pair.coordinate] -= gradient[k].a;
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

/// A path between two bodies on a ball-like chain: three coordinates that cannot be separated.
TEST(FittedPaths, OfThreeCoordinatesFollowTheStraightLine) {
  Model model;
  model.bodies = {Body{.name = "ground"}};
  for (int i = 0; i < 3; ++i) {
    Body body;
    body.name = "link" + std::to_string(i);
    body.mass = 1.0;
    model.bodies.push_back(body);
    Joint joint;
    joint.name = "joint" + std::to_string(i);
    joint.parent = i;
    joint.child = i + 1;
    joint.parent_frame.translation = Eigen::Vector3d(0.05, 0.1, 0.02 * i);
    joint.coordinates = {i};
    joint.rotation[0].axis = Eigen::Vector3d::Unit(i);
    joint.rotation[0].coordinate = i;
    joint.rotation[0].function = numerics::PiecewisePolynomial::linear(1.0, 0.0);
    model.joints.push_back(joint);
    Coordinate coordinate;
    coordinate.name = "q" + std::to_string(i);
    coordinate.joint = i;
    coordinate.low = -0.8;
    coordinate.high = 0.8;
    model.coordinates.push_back(coordinate);
  }
  Muscle muscle;
  muscle.parameters.name = "cord";
  PathPoint a, b;
  a.name = "a";
  a.location = Eigen::Vector3d(0.1, -0.05, 0.0);
  b.name = "b";
  b.body = 3;
  b.location = Eigen::Vector3d(0.02, 0.2, 0.07);
  muscle.points = {a, b};
  model.muscles = {muscle};
  const Fit fit(model);
  ASSERT_EQ(fit.fitted.errors()[0].coordinates.size(), 3u);
  EXPECT_LT(fit.fitted.errors()[0].length, 1e-4);
  EXPECT_LT(fit.fitted.errors()[0].moment_arm, 1e-4);
  expect_stated_errors(fit);
}

/// Where a fit is not good enough, mixed paths are the exact ones.
TEST(FittedPaths, AreExactWhereNoFitIsGoodEnough) {
  PathFitOptions options;
  options.mixed = true;
  const Fit plain(load_model("arm").model());
  const Fit mixed(load_model("arm").model(), options);
  options.tolerance = 1e-12;
  options.max_degree = 3;
  options.panels = 4;
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
