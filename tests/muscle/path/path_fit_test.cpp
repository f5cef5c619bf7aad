#include "veridyn/muscle/path/path_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "tests/muscle/path/fit.hpp"
#include "tests/support/folders.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/path/path_workspace.hpp"

namespace veridyn::muscle {
namespace {

using test::Fit;

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
      const Coordinate& k = fit.model.coordinates[c];
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

/// Arms at poses along each coordinate, as dense as one passes over a side change: nowhere further off than a
/// simulation may take; `close`: almost everywhere within the tolerance.
void expect_arms_along(const Fit& fit, bool close) {
  Kinematics<double> kinematics(fit.mechanism);
  PathWorkspace<double> workspace(fit.exact), scratch(fit.exact);
  std::vector<double> length(static_cast<std::size_t>(fit.fitted.muscles())), gradient(fit.fitted.pairs().size());
  constexpr int kPoses = 5000;
  std::vector<int> above(gradient.size(), 0);
  for (std::size_t c = 0; c < fit.model.coordinates.size(); ++c) {
    const Coordinate& k = fit.model.coordinates[c];
    for (int i = 0; i < kPoses; ++i) {
      Eigen::VectorXd q = fit.model.default_pose();
      q[static_cast<int>(c)] = k.low + (k.high - k.low) * (i + 0.37) / kPoses;
      update_positions(fit.mechanism, q.data(), kinematics);
      fit.exact.evaluate(kinematics, q.data(), workspace);
      fit.fitted.evaluate(fit.exact, kinematics, q.data(), scratch, length.data(), gradient.data());
      for (std::size_t p = 0; p < gradient.size(); ++p) {
        const auto [muscle, coordinate] = fit.fitted.pairs()[p];
        double exact = 0.0;
        for (std::size_t e = fit.exact.first_pair(muscle); e < fit.exact.end_pair(muscle); ++e)
          if (fit.exact.pairs()[e].coordinate == coordinate) exact = workspace.gradient[e];
        const double off = std::abs(gradient[p] - exact);
        ASSERT_LT(off, 1e-3) << fit.model.muscles[muscle].name() << " at " << q.transpose();
        if (off > 1e-4) ++above[p];
      }
    }
  }
  for (const int n : above) EXPECT_TRUE(!close || n < kPoses / 100) << n;
}

TEST(FittedPaths, OfTheBuiltInArmKeepTheirTolerance) {
  const Fit fit(load_model("arm").model(), {.mixed = true});
  for (const PathFitError& e : fit.fitted.errors()) {
    EXPECT_TRUE(e.fitted) << e.muscle;
    EXPECT_LT(e.length, 1e-4) << e.muscle;
    EXPECT_LT(e.moment_arm, 1e-3) << e.muscle;
    EXPECT_LT(e.above_tolerance, 0.03) << e.muscle;
  }
  expect_stated_errors(fit);
  expect_arms_along(fit, true);
}

TEST(FittedPaths, OfArm26KeepTheirTolerance) {
  const std::filesystem::path file = veridyn::test::shared_folder() / "data/opensim/arm26.osim";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "the OpenSim models of ../shared/data are not here";
  const Fit fit(read_osim(file), {.mixed = true});
  for (const PathFitError& e : fit.fitted.errors()) {
    EXPECT_TRUE(e.fitted) << e.muscle;
    EXPECT_LT(e.length, 1e-4) << e.muscle;
    EXPECT_LT(e.moment_arm, 1e-4) << e.muscle;
  }
  EXPECT_EQ(fit.fitted.pairs().size(), 9u);
  expect_stated_errors(fit);
  expect_arms_along(fit, true);
}

TEST(FittedPaths, ThatMissTheirToleranceStayExact) {
  const std::filesystem::path file = veridyn::test::shared_folder() / "data/opensim/gait10dof18musc.osim";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "the OpenSim models of ../shared/data are not here";
  const Fit fit(read_osim(file), {.mixed = true});
  int exact = 0;
  for (const PathFitError& e : fit.fitted.errors()) {
    if (e.fitted) {
      EXPECT_LT(e.moment_arm, 1e-3) << e.muscle;
    }
    exact += e.fitted ? 0 : 1;
  }
  EXPECT_GT(exact, 0);  // rectus femoris: a conditional point that depends on hip and knee together
  EXPECT_LT(exact, 6);
  expect_arms_along(fit, false);
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

}  // namespace
}  // namespace veridyn::muscle
