#include "veridyn/muscle/path/path_functions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/muscle/path/fit.hpp"
#include "tests/support/refusal.hpp"
#include "veridyn/muscle/model/simulation_jet.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"
#include "veridyn/muscle/path/path_workspace.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::muscle {
namespace {

using test::Fit;
using ::testing::HasSubstr;

/// The built-in arm with two more muscles: one of both angles x (elbow) and y (shoulder),
/// L = 0.3 + 0.02 y - 0.05 x + 0.01 x y + 0.03 x^2, and one of the shoulder, 0.2 + 0.04 y + 0.01 y^2.
Model arm_with_functions() {
  Model model = load_model("arm").model();
  Muscle two;
  two.parameters = model.muscles[0].parameters;
  two.parameters.name = "two";
  two.function = PathFunction{
      .coordinates = {1, 0},
      .length = numerics::MultivariatePolynomial(2, 2, std::vector<double>{0.3, 0.02, 0.0, -0.05, 0.01, 0.03})};
  Muscle one = two;
  one.parameters.name = "one";
  one.function = PathFunction{.coordinates = {0},
                              .length = numerics::PiecewisePolynomial::polynomial(std::array{0.2, 0.04, 0.01})};
  model.muscles.insert(model.muscles.begin() + 1, two);
  model.muscles.push_back(one);
  return model;
}

constexpr int kTwo = 1, kOne = 7;

TEST(PathFunctions, GiveTheLengthAndItsSlopesInClosedForm) {
  const Fit fit(arm_with_functions());
  ASSERT_TRUE(fit.exact.by_function(kTwo) && fit.exact.by_function(kOne));
  ASSERT_FALSE(fit.exact.by_function(0));
  Kinematics<double> kinematics(fit.mechanism);
  PathWorkspace<double> w(fit.exact), lengths(fit.exact);
  std::vector<double> length(8), gradient(fit.fitted.pairs().size());
  const double y = 0.4, x = 1.1, q[2] = {y, x};
  update_positions(fit.mechanism, q, kinematics);
  fit.exact.evaluate(kinematics, q, w);
  fit.exact.lengths(kinematics, q, lengths);
  EXPECT_TRUE(fit.fitted.evaluate(q, length.data(), gradient.data()));
  const double of_two = 0.3 + 0.02 * y - 0.05 * x + 0.01 * x * y + 0.03 * x * x;
  const double of_one = 0.2 + 0.04 * y + 0.01 * y * y;
  for (const auto& all : {w.length, lengths.length, length}) {
    EXPECT_NEAR(all[kTwo], of_two, 1e-15);
    EXPECT_NEAR(all[kOne], of_one, 1e-15);
  }
  const auto expect = [&](std::span<const MusclePaths::Pair> pairs, const std::vector<double>& slope) {
    int found = 0;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const bool one = pairs[k].muscle == kOne, two = pairs[k].muscle == kTwo;
      if (!one && !two) continue;
      const double of_two_by[2] = {0.02 + 0.01 * x, -0.05 + 0.01 * y + 0.06 * x};
      EXPECT_NEAR(slope[k], one ? 0.04 + 0.02 * y : of_two_by[pairs[k].coordinate], 1e-15);
      ++found;
    }
    EXPECT_EQ(found, 3);
  };
  expect(fit.exact.pairs(), w.gradient);
  expect(fit.fitted.pairs(), gradient);
  double speeds[8];
  const double qdot[2] = {0.7, -0.3};
  fit.exact.speeds(w, qdot, speeds);
  EXPECT_NEAR(speeds[kTwo], 0.7 * (0.02 + 0.01 * x) - 0.3 * (-0.05 + 0.01 * y + 0.06 * x), 1e-15);
}

TEST(PathFunctions, HaveTheAutomaticDerivativesOfTheirFormulasAndCentralDifferences) {
  const Fit fit(arm_with_functions());
  Kinematics<SimulationJet> kinematics(fit.mechanism);
  PathWorkspace<SimulationJet> w(fit.exact);
  const double y = -0.3, x = 0.8;
  const SimulationJet q[2] = {SimulationJet(y, 0), SimulationJet(x, 1)};
  update_positions(fit.mechanism, q, kinematics);
  fit.exact.evaluate(kinematics, q, w);
  EXPECT_NEAR(w.length[kTwo].v(0), 0.02 + 0.01 * x, 1e-15);
  EXPECT_NEAR(w.length[kTwo].v(1), -0.05 + 0.01 * y + 0.06 * x, 1e-15);
  const std::size_t by_y = fit.exact.first_pair(kTwo), by_x = by_y + 1;
  ASSERT_EQ(fit.exact.pairs()[by_y].coordinate, 0);
  EXPECT_EQ(w.gradient[by_y].v(0), 0.0);
  EXPECT_NEAR(w.gradient[by_y].v(1), 0.01, 1e-16);
  EXPECT_NEAR(w.gradient[by_x].v(0), 0.01, 1e-16);
  EXPECT_NEAR(w.gradient[by_x].v(1), 0.06, 1e-16);
  EXPECT_NEAR(w.gradient[fit.exact.first_pair(kOne)].v(0), 0.02, 1e-16);
  // Of a length that is quadratic central differences are exact.
  Kinematics<double> posed(fit.mechanism);
  PathWorkspace<double> there(fit.exact);
  const auto length_at = [&](double dy, double dx) {
    const double moved[2] = {y + dy, x + dx};
    update_positions(fit.mechanism, moved, posed);
    fit.exact.lengths(posed, moved, there);
    return there.length[kTwo];
  };
  constexpr double kStep = 0.01;
  EXPECT_NEAR((length_at(kStep, 0.0) - length_at(-kStep, 0.0)) / (2.0 * kStep), w.gradient[by_y].a, 1e-13);
  EXPECT_NEAR((length_at(0.0, kStep) - length_at(0.0, -kStep)) / (2.0 * kStep), w.gradient[by_x].a, 1e-13);
}

// They are fitted by nothing, so that a mixed fit whose tolerance no polynomial meets has them as they are.
TEST(PathFunctions, StayAsTheyAreAmongFittedAndExactPaths) {
  PathFitOptions options;
  options.mixed = true;
  options.tolerance = 1e-14;
  options.max_degree = 2;
  const Fit strict(arm_with_functions(), options);
  EXPECT_TRUE(strict.fitted.errors()[kTwo].given && strict.fitted.errors()[kTwo].fitted);
  EXPECT_EQ(strict.fitted.errors()[kTwo].length, 0.0);
  EXPECT_EQ(strict.fitted.errors()[kTwo].terms, 6);
  EXPECT_FALSE(strict.fitted.errors()[0].fitted);
  Kinematics<double> kinematics(strict.mechanism);
  PathWorkspace<double> w(strict.exact), inner(strict.exact);
  std::vector<double> length(8), gradient(strict.fitted.pairs().size());
  numerics::RandomStream random(4, "poses");
  for (int i = 0; i < 20; ++i) {
    const double q[2] = {random.uniform(-0.5, 1.5), random.uniform(0.1, 2.0)};
    update_positions(strict.mechanism, q, kinematics);
    strict.exact.evaluate(kinematics, q, w);
    EXPECT_TRUE(strict.fitted.evaluate(strict.exact, kinematics, q, inner, length.data(), gradient.data()));
    for (std::size_t m = 0; m < 8; ++m) EXPECT_EQ(length[m], w.length[m]) << m;
    ASSERT_EQ(gradient.size(), w.gradient.size());
    for (std::size_t k = 0; k < gradient.size(); ++k) EXPECT_EQ(gradient[k], w.gradient[k]) << k;
  }
}

TEST(PathFunctions, AreNowhereAndSayWhenACoordinateIsOutsideItsRange) {
  const Fit fit(arm_with_functions());
  Kinematics<double> kinematics(fit.mechanism);
  PathWorkspace<double> w(fit.exact);
  const double q[2] = {0.4, 1.1};
  update_positions(fit.mechanism, q, kinematics);
  EXPECT_TRUE(fit.exact.polyline(kinematics, q, kTwo).empty());
  EXPECT_TRUE(fit.exact.touched(kinematics, q, kTwo).empty());
  EXPECT_FALSE(fit.exact.can_wrap(kTwo));
  std::vector<SpatialVector<double>> by_link(static_cast<std::size_t>(fit.mechanism.links()));
  fit.exact.add_tension(kinematics, q, kTwo, 100.0, w, by_link);
  for (const SpatialVector<double>& f : by_link) EXPECT_EQ(f.linear.norm() + f.angular.norm(), 0.0);
  PathFunctions functions;
  Model model = arm_with_functions();
  EXPECT_THAT(functions.add(model, kTwo, 0), testing::ElementsAre(0, 1)) << "ascending";
  EXPECT_TRUE(functions.inside(q));
  const double beyond[2] = {0.4, model.coordinates[1].high + 0.1};
  EXPECT_FALSE(functions.inside(beyond));
  model.muscles[kTwo].function->coordinates = {1, 1};
  EXPECT_THAT(why([&] { static_cast<void>(functions.add(model, kTwo, 0)); }),
              HasSubstr("muscle two: the arguments of its length must be different coordinates"));
  model.muscles[kTwo].function->coordinates = {1};
  EXPECT_THAT(why([&] { static_cast<void>(functions.add(model, kTwo, 0)); }),
              HasSubstr("its length is a function of 2, and it has 1 coordinates"));
}

}  // namespace
}  // namespace veridyn::muscle
