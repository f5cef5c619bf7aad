#include "veridyn/muscle/actuator/fiber_solver.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/muscle/osim/builtin_models.hpp"
#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {
namespace {

class FiberSolverOfTheArm : public ::testing::Test {
 protected:
  explicit FiberSolverOfTheArm()
      : muscles(muscle_parameters(load_model("arm").model())),
        n(muscles.size()),
        solver(n),
        excitation(n, 0.02),
        activation(n, 0.02),
        path(n),
        speed(n, 0.0),
        fiber(n),
        activation_rate(n),
        velocity(n),
        force(n) {
    for (std::size_t m = 0; m < n; ++m) {
      const MusculotendonParameters<double>& p = muscles.settings(m).musculotendon;
      path[m] = p.optimal_fiber_length + 1.01 * p.tendon_slack_length;
      fiber[m] = p.optimal_fiber_length;
    }
  }
  [[nodiscard]] MuscleInputs<double> in() { return {excitation, activation, fiber, path, speed}; }
  [[nodiscard]] MuscleOutputs<double> out() { return {activation_rate, velocity, force}; }
  [[nodiscard]] bool solve(double step) {
    base = fiber;
    return solver.solve(muscles, step, in(), fiber, out());
  }
  /// That the solution holds: the equation's sides change places within 1e-7 of it, and forces belong to it.
  void expect_solution(double step) {
    const std::vector<double> solution = fiber, solved = velocity, of_solution = force;
    muscles.tendon_forces(in(), force);
    EXPECT_EQ(force, of_solution);
    for (const double side : {-1.0, 1.0}) {
      for (std::size_t m = 0; m < n; ++m)
        fiber[m] = solution[m] + side * 1e-7 * muscles.settings(m).musculotendon.optimal_fiber_length;
      muscles.rates(in(), out());
      for (std::size_t m = 0; m < n; ++m)
        EXPECT_GT(side * (fiber[m] - base[m] - step * velocity[m]), 0.0) << m << " at " << side;
    }
    fiber = solution;
    for (std::size_t m = 0; m < n; ++m) EXPECT_NEAR(solved[m], (fiber[m] - base[m]) / step, 1e-9) << m;
  }
  MuscleGroup<double> muscles;
  std::size_t n;
  FiberSolver solver;
  std::vector<double> excitation, activation, path, speed, fiber, activation_rate, velocity, force, base;
};

TEST_F(FiberSolverOfTheArm, SolvesTheStageForShortAndLongSteps) {
  for (const double step : {1e-9, 1e-5, 1e-3, 2.5e-3, 0.1}) {
    ASSERT_TRUE(solve(step)) << step;
    expect_solution(step);
  }
}

TEST_F(FiberSolverOfTheArm, FollowsAPathWithFewEvaluationsFromOneStageToTheNext) {
  for (int i = 0; i < 40; ++i) {
    for (std::size_t m = 0; m < n; ++m) path[m] += (m < 3 ? 1.0 : -1.0) * 2e-4;
    for (double& a : activation) a = 0.02 + 0.01 * i;
    ASSERT_TRUE(solve(2e-3)) << i;
    expect_solution(2e-3);
  }
}

TEST_F(FiberSolverOfTheArm, RestsWhereTheFiberRests) {
  muscles.equilibrium(activation, path, fiber);
  const std::vector<double> rest = fiber;
  ASSERT_TRUE(solve(1e-3));
  for (std::size_t m = 0; m < n; ++m) EXPECT_NEAR(fiber[m], rest[m], 1e-11);
}

TEST_F(FiberSolverOfTheArm, ALongStepEndsInEquilibrium) {
  std::vector<double> rest(n);
  muscles.equilibrium(activation, path, rest);
  ASSERT_TRUE(solve(1e5));
  for (std::size_t m = 0; m < n; ++m) EXPECT_NEAR(fiber[m], rest[m], 1e-5);
}

TEST_F(FiberSolverOfTheArm, AFiberThatWouldBecomeTooShortEndsAtItsLeastLength) {
  // The path gives way by a fibre's length: the tendon is slack, and the fibre contracts as fast as it can.
  activation.assign(n, 1.0);
  for (std::size_t m = 0; m < n; ++m) path[m] -= muscles.settings(m).musculotendon.optimal_fiber_length;
  ASSERT_TRUE(solve(0.2));
  std::vector<double> value(2 * n);
  muscles.events(in(), value);
  for (std::size_t m = 0; m < n; ++m) {
    EXPECT_NEAR(value[2 * m], 0.0, 2e-7) << m;
    EXPECT_LT(velocity[m], 0.0) << m;
  }
}

TEST_F(FiberSolverOfTheArm, SaysWhereThereIsNoSolution) {
  path[2] = kNaN;
  EXPECT_FALSE(solve(1e-3));
}

}  // namespace
}  // namespace veridyn::muscle
