#include "veridyn/muscle/simulation/static_optimization.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <cmath>
#include <random>

#include "tests/muscle/arm26_muscles.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::muscle {
namespace {

struct Problem {
  std::vector<MuscleParameters> muscles;
  Eigen::MatrixXd arms;
  Eigen::VectorXd length, speed, required;
};

Problem random_problem(std::mt19937_64& generator, int n, int m, const MuscleCurves& curves) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Problem q;
  const std::vector<MuscleParameters> arm = arm26_muscles(curves);
  q.arms.setZero(n, m);
  q.length.resize(n);
  q.speed.resize(n);
  for (int i = 0; i < n; ++i) {
    q.muscles.push_back(arm[static_cast<std::size_t>(i) % arm.size()]);
    MuscleParameters& p = q.muscles.back();
    p.musculotendon.max_isometric_force *= 0.5 + uniform(generator);
    q.length(i) =
        p.musculotendon.tendon_slack_length + p.musculotendon.optimal_fiber_length * (0.7 + 0.5 * uniform(generator));
    q.speed(i) = 0.4 * (uniform(generator) - 0.5);
    for (int j = 0; j < m; ++j)
      if (uniform(generator) < 0.6) q.arms(i, j) = 0.1 * (uniform(generator) - 0.5);
  }
  q.required = Eigen::VectorXd::NullaryExpr(m, [&] { return 6.0 * (uniform(generator) - 0.5); });
  return q;
}

// Karush, Kuhn and Tucker: with multipliers found by least squares from the free controls, each control at a bound must
// want to cross it.
void expect_optimal(const Problem& q, const StaticOptimizationOptions& options, const StaticOptimizationFrame& f) {
  const Eigen::Index n = q.arms.rows(), m = q.arms.cols();
  ASSERT_EQ(f.end, StaticEnd::kBalanced);
  EXPECT_LT(f.unbalanced.cwiseAbs().maxCoeff(), 1e-8);
  const double p = options.exponent;
  // dF/da by differences of the formulation itself
  const MuscleGroup<double> group(q.muscles);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto force = [&](double a) {
      if (options.force == StaticForce::kIsometric) return a * q.muscles[i].musculotendon.max_isometric_force;
      if (options.force == StaticForce::kAsOpenSim)
        return a * group.rigid_forces(i, 1.0, q.length(i), q.speed(i)).active;
      const RigidTendonForces r = group.rigid_forces(i, a, q.length(i), q.speed(i));
      return r.active + r.passive;
    };
    const double a = f.activation(i), h = 1e-6;
    EXPECT_NEAR(f.force(i), force(a), 1e-7 * (1.0 + std::abs(f.force(i))));
    const double gain = (force(a + h) - force(a - h)) / (2.0 * h);
    const double pull = gain * q.arms.row(i).dot(f.multiplier), cost = p * std::pow(a, p - 1.0);
    const double slack = 1e-6 * (1.0 + std::abs(pull));
    EXPECT_GE(a, q.muscles[i].min_control);
    EXPECT_LE(a, q.muscles[i].max_control);
    if (a > q.muscles[i].min_control + 1e-9) {
      EXPECT_GE(pull - cost, -slack) << i;
    }
    if (a < q.muscles[i].max_control - 1e-9) {
      EXPECT_LE(pull - cost, slack) << i;
    }
  }
  for (Eigen::Index j = 0; j < m && !options.reserve.empty(); ++j) {
    const double c = f.reserve(j);
    EXPECT_NEAR(std::copysign(p * std::pow(std::abs(c), p - 1.0), c), options.reserve[j] * f.multiplier(j),
                1e-6 * (1.0 + std::abs(f.multiplier(j))));
  }
}

TEST(StaticOptimization, MeetsTheOptimalityConditionsOfRandomProblems) {
  std::mt19937_64 generator(4);
  for (const StaticForce force : {StaticForce::kAsOpenSim, StaticForce::kWithPassive, StaticForce::kIsometric})
    for (const double p : {2.0, 3.0, 1.5, 4.0})
      for (const auto& [n, m] : {std::pair{6, 2}, std::pair{20, 5}, std::pair{92, 12}}) {
        SCOPED_TRACE(fmt::format("formulation {}, exponent {}, {} muscles", static_cast<int>(force), p, n));
        const Problem q = random_problem(generator, n, m, arm26_thelen());
        const StaticOptimizationOptions options{
            .exponent = p, .force = force, .reserve = std::vector<double>(static_cast<std::size_t>(m), 1.0)};
        StaticOptimizer optimizer(q.muscles, options);
        StaticOptimizationFrame frame;
        optimizer.solve(q.arms, q.length, q.speed, q.required, frame);
        expect_optimal(q, options, frame);
        // The next frame, from this one.
        Problem next = q;
        next.required *= 1.03;
        optimizer.solve(next.arms, next.length, next.speed, next.required, frame);
        expect_optimal(next, options, frame);
      }
}

// Two muscles and a reserve on one coordinate: the closed form of Lagrange.
TEST(StaticOptimization, SharesAsTheClosedFormSays) {
  std::vector<MuscleParameters> muscles(2);
  muscles[0].musculotendon.max_isometric_force = 100.0;
  muscles[1].musculotendon.max_isometric_force = 300.0;
  for (MuscleParameters& p : muscles) p.min_control = 0.0;
  StaticOptimizer optimizer(muscles, {.force = StaticForce::kIsometric, .reserve = {2.0}});
  Eigen::MatrixXd arms(2, 1);
  arms << 0.05, 0.02;
  const Eigen::VectorXd any = Eigen::VectorXd::Constant(2, 0.3);
  StaticOptimizationFrame f;
  optimizer.solve(arms, any, any, Eigen::VectorXd::Constant(1, 3.0), f);
  const double sum = 25.0 + 36.0 + 4.0;
  EXPECT_NEAR(f.activation(0), 3.0 * 5.0 / sum, 1e-13);
  EXPECT_NEAR(f.activation(1), 3.0 * 6.0 / sum, 1e-13);
  EXPECT_NEAR(f.reserve(0), 3.0 * 2.0 / sum, 1e-13);
  EXPECT_LE(f.iterations, 4);
  // With p = 3 shares go with the square root of the gains.
  StaticOptimizer cubic(muscles, {.exponent = 3.0, .force = StaticForce::kIsometric});
  cubic.solve(arms, any, any, Eigen::VectorXd::Constant(1, 3.0), f);
  const double k = 3.0 / (std::pow(5.0, 1.5) + std::pow(6.0, 1.5));
  EXPECT_NEAR(f.activation(0), k * std::sqrt(5.0), 1e-9);
  EXPECT_NEAR(f.activation(1), k * std::sqrt(6.0), 1e-9);
}

// Brute force: no control on a fine grid that balances costs less.
TEST(StaticOptimization, NoPointOfAGridIsBetter) {
  std::mt19937_64 generator(9);
  for (int trial = 0; trial < 20; ++trial) {
    const Problem q = random_problem(generator, 3, 1, MillardCurves{});
    const StaticOptimizationOptions options{.exponent = 2.0, .reserve = {5.0}};
    StaticOptimizer optimizer(q.muscles, options);
    StaticOptimizationFrame f;
    optimizer.solve(q.arms, q.length, q.speed, q.required, f);
    ASSERT_TRUE(f.usable());
    double least = 1e300;
    const MuscleGroup<double> group(q.muscles);
    Eigen::Vector3d gain;
    for (int i = 0; i < 3; ++i)
      gain(i) = group.rigid_forces(static_cast<std::size_t>(i), 1.0, q.length(i), q.speed(i)).active * q.arms(i, 0);
    const int steps = 60;
    for (int a = 0; a <= steps; ++a)
      for (int b = 0; b <= steps; ++b)
        for (int c = 0; c <= steps; ++c) {
          const Eigen::Vector3d x = Eigen::Vector3d(a, b, c) / steps * 0.99 + Eigen::Vector3d::Constant(0.01);
          const double reserve = (q.required(0) - gain.dot(x)) / 5.0;
          least = std::min(least, x.squaredNorm() + reserve * reserve);
        }
    EXPECT_LE(f.cost, least + 1e-12);
    EXPECT_NEAR(f.cost, least, 0.05);
  }
}

TEST(StaticOptimization, SaysWhatStaysUnbalancedWhenMusclesAreTooWeak) {
  std::vector<MuscleParameters> muscles(2);
  muscles[0].musculotendon.max_isometric_force = 100.0;
  muscles[1].musculotendon.max_isometric_force = 300.0;
  Eigen::MatrixXd arms(2, 1);
  arms << 0.05, 0.02;
  const Eigen::VectorXd any = Eigen::VectorXd::Constant(2, 0.3);
  StaticOptimizer weak(muscles, {.force = StaticForce::kIsometric});
  StaticOptimizationFrame f;
  weak.solve(arms, any, any, Eigen::VectorXd::Constant(1, 14.0), f);
  EXPECT_EQ(f.end, StaticEnd::kInfeasible);
  EXPECT_NEAR(f.unbalanced(0), 3.0, 1e-9);
  EXPECT_NEAR(f.activation(0), 1.0, 1e-12);
  // A balanced frame after it is not disturbed by it.
  weak.solve(arms, any, any, Eigen::VectorXd::Constant(1, 5.0), f);
  EXPECT_TRUE(f.usable());
  // The wrong direction: muscles can only pull.
  weak.solve(arms, any, any, Eigen::VectorXd::Constant(1, -4.0), f);
  EXPECT_EQ(f.end, StaticEnd::kInfeasible);
  EXPECT_NEAR(f.unbalanced(0), -4.0 - 0.01 * 11.0, 1e-9);
  // A reserve takes it, and says so.
  StaticOptimizer helped(muscles, {.force = StaticForce::kIsometric, .reserve = {1.0}});
  helped.solve(arms, any, any, Eigen::VectorXd::Constant(1, 14.0), f);
  EXPECT_TRUE(f.usable());
  EXPECT_NEAR(f.reserve(0), 3.0, 1e-9);
  // NaN ends, too.
  helped.solve(arms, any, any, Eigen::VectorXd::Constant(1, std::nan("")), f);
  EXPECT_FALSE(f.usable());
}

TEST(StaticOptimization, RejectsOptionsThatMakeNoSense) {
  const std::vector<MuscleParameters> muscles(1);
  EXPECT_THROW(StaticOptimizer(muscles, {.exponent = 1.0}), InputError);
  EXPECT_THROW(StaticOptimizer(muscles, {.exponent = std::nan("")}), InputError);
  EXPECT_THROW(StaticOptimizer(muscles, {.reserve = {-1.0}}), InputError);
  std::vector<MuscleParameters> reversed(1);
  reversed[0].min_control = 0.5;
  reversed[0].max_control = 0.2;
  EXPECT_THROW(StaticOptimizer(reversed, {}), InputError);
}

// Along the motions that loops allow: as a problem of its own coordinates.
TEST(StaticOptimization, BalancesAlongGivenDirectionsAlone) {
  std::mt19937_64 generator(31);
  int balanced = 0;
  for (int trial = 0; trial < 20; ++trial) {
    Problem q = random_problem(generator, 8, 4, ThelenCurves{});
    const Eigen::MatrixXd directions =
        Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(
                            4, 2, [&] { return std::uniform_real_distribution<double>(-1.0, 1.0)(generator); })
                            .householderQr()
                            .householderQ())
            .leftCols(2);
    StaticOptimizer along(q.muscles, {.reserve = {1.0, 2.0, 0.0, 0.5}});
    StaticOptimizationFrame frame;
    along.solve(q.arms, q.length, q.speed, q.required, frame, &directions);
    ASSERT_EQ(frame.end, StaticEnd::kBalanced);
    Eigen::VectorXd left = q.required - q.arms.transpose() * frame.force;
    for (Eigen::Index j = 0; j < 4; ++j)
      left(j) -= along.options().reserve[static_cast<std::size_t>(j)] * frame.reserve(j);
    EXPECT_LT((directions.transpose() * left).norm(), 1e-8);
    EXPECT_GT(left.norm(), 1e-3) << "what loops carry";
    EXPECT_LT(frame.unbalanced.norm(), 1e-8);
    // Reserves are as costly as muscles: c = r_j (N lambda)_j / 2.
    for (Eigen::Index j = 0; j < 4; ++j)
      EXPECT_NEAR(frame.reserve(j), 0.5 * along.options().reserve[static_cast<std::size_t>(j)] * frame.multiplier(j),
                  1e-9);
    // Without reserves: the same as the reduced problem.
    StaticOptimizer free(q.muscles, {}), reduced(q.muscles, {});
    StaticOptimizationFrame by_directions, by_hand;
    free.solve(q.arms, q.length, q.speed, q.required, by_directions, &directions);
    reduced.solve(q.arms * directions, q.length, q.speed, directions.transpose() * q.required, by_hand);
    ASSERT_EQ(by_directions.end, by_hand.end);
    if (by_hand.end != StaticEnd::kBalanced) continue;  // muscles only pull
    ++balanced;
    EXPECT_LT((by_directions.activation - by_hand.activation).cwiseAbs().maxCoeff(), 1e-9);
    // A basis turned from frame to frame is the same problem.
    const Eigen::MatrixXd turned = directions * Eigen::Rotation2Dd(0.8).toRotationMatrix();
    free.solve(q.arms, q.length, q.speed, q.required, by_directions, &turned);
    EXPECT_LT((by_directions.activation - by_hand.activation).cwiseAbs().maxCoeff(), 1e-8);
  }
  EXPECT_GT(balanced, 5);
}

}  // namespace
}  // namespace veridyn::muscle
