#include "veridyn/numerics/optimal_control/horizon_programme.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/linear_algebra/general_eigen.hpp"
#include "veridyn/numerics/linear_systems/riccati.hpp"

namespace veridyn::numerics {
namespace {

using Programme = HorizonProgramme<4, 1>;
using Large = HorizonProgramme<9, 2>;

/// A random stable system with a positive cost, the same at every stage.
template <int kStates, int kInputs>
void fill(HorizonProgramme<kStates, kInputs>& p, unsigned seed) {
  using P = HorizonProgramme<kStates, kInputs>;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto entry = [&](double) { return normal(random); };
  typename P::Stage s;
  s.A = P::StateMatrix::NullaryExpr([&] { return entry(0.0); }) * 0.3 + 0.7 * P::StateMatrix::Identity();
  s.A /= std::max(1.0, 1.02 * general_eigenvalues(s.A).cwiseAbs().maxCoeff());
  s.B = P::Map::NullaryExpr([&] { return entry(0.0); });
  const typename P::StateMatrix L = P::StateMatrix::NullaryExpr([&] { return entry(0.0); });
  s.Q = L * L.transpose() / kStates;
  s.R = 0.1 * P::InputMatrix::Identity();
  for (auto& stage : p.stages) {
    stage = s;
    stage.q = 0.3 * P::State::NullaryExpr([&] { return entry(0.0); });
    stage.b = 0.1 * P::State::NullaryExpr([&] { return entry(0.0); });
  }
}

TEST(HorizonProgramme, WithoutBoundsIsTheLinearQuadraticRegulator) {
  Programme p(200);
  fill(p, 3);
  for (auto& s : p.stages) {
    s.q.setZero();
    s.b.setZero();
  }
  const LinearQuadratic lq = discrete_linear_quadratic(p.stages[0].A, p.stages[0].B, p.stages[0].Q, p.stages[0].R);
  p.stages.back().Q = lq.P;
  const Programme::State x0(1.0, -0.5, 0.3, 0.7);
  const ProgrammeResult r = p.solve(x0);
  EXPECT_EQ(r.end, ProgrammeEnd::kSolved);
  EXPECT_LE(r.iterations, 2);
  EXPECT_NEAR(p.inputs()[0](0), -(lq.K * x0)(0), 1e-9);
  EXPECT_NEAR(r.cost, 0.5 * x0.dot(lq.P * x0), 1e-8 * r.cost);
}

/// A mass to be brought to 1 under |force| <= 1, |speed| <= 0.5, position <= 0.8.
Programme mass(std::size_t n) {
  Programme p(n);
  const double h = 0.1;
  for (auto& s : p.stages) {
    s.A.setIdentity();
    s.A(0, 1) = h;
    s.B << 0.5 * h * h, h, 0.0, 0.0;
    s.Q(0, 0) = 1.0;
    s.q(0) = -1.0;
    s.R(0, 0) = 1e-3;
    s.u_low(0) = -1.0;
    s.u_high(0) = 1.0;
    s.x_high(1) = 0.5;
    s.x_low(1) = -0.5;
    s.x_high(0) = 0.8;
  }
  return p;
}

TEST(HorizonProgramme, KeepsItsBoundsAndStopsAtThem) {
  Programme p = mass(60);
  const ProgrammeResult r = p.solve(Programme::State::Zero());
  ASSERT_EQ(r.end, ProgrammeEnd::kSolved);
  EXPECT_LT(r.iterations, 25);
  double fastest = 0.0;
  for (const auto& x : p.states()) {
    EXPECT_LE(x(0), 0.8 + 1e-9);
    EXPECT_LE(std::abs(x(1)), 0.5 + 1e-9);
    fastest = std::max(fastest, x(1));
  }
  for (const auto& u : p.inputs()) EXPECT_LE(std::abs(u(0)), 1.0 + 1e-9);
  EXPECT_NEAR(fastest, 0.5, 1e-6);
  EXPECT_NEAR(p.states().back()(0), 0.8, 1e-6);
  EXPECT_NEAR(p.inputs()[0](0), 1.0, 1e-6);
}

TEST(HorizonProgramme, SatisfiesTheOptimalityConditionsOfRandomProblems) {
  // For a convex programme stationarity, bounds, signs and complementarity are sufficient. Stationarity is checked here
  // by moving every input, dynamics included: within the bounds nothing is cheaper.
  int active = 0;
  for (unsigned seed = 1; seed <= 50; ++seed) {
    Large p(15);
    fill(p, seed);
    for (auto& s : p.stages) {
      s.u_low.setConstant(-0.4);
      s.u_high.setConstant(0.3);
      s.x_high(0) = 3.0;
    }
    const Large::State x0 = Large::State::Constant(0.2);
    const ProgrammeResult r = p.solve(x0, {.iterations = 60});
    ASSERT_EQ(r.end, ProgrammeEnd::kSolved) << seed << " " << r.gradient << " " << r.violation;
    const auto cost = [&](std::vector<Large::Input> u, bool& inside) {
      Large::State x = x0;
      double sum = 0.0;
      inside = true;
      for (std::size_t k = 0; k < p.stages.size(); ++k) {
        const auto& s = p.stages[k];
        sum += 0.5 * x.dot(s.Q * x) + s.q.dot(x);
        if (k > 0) inside = inside && x(0) <= 3.0 + 1e-12;
        if (k == u.size()) break;
        sum += 0.5 * u[k].dot(s.R * u[k]) + s.r.dot(u[k]);
        x = s.A * x + s.B * u[k] + s.b;
      }
      return sum;
    };
    bool inside = false;
    EXPECT_NEAR(cost(p.inputs(), inside), r.cost, 1e-9 * (1.0 + std::abs(r.cost)));
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    for (int trial = 0; trial < 40; ++trial) {
      std::vector<Large::Input> u = p.inputs();
      const double size = std::pow(10.0, -1.0 - trial % 4);
      for (auto& v : u) {
        v += size * Large::Input(normal(random), normal(random));
        v = v.cwiseMax(-0.4).cwiseMin(0.3);
      }
      const double other = cost(u, inside);
      if (!inside) continue;
      EXPECT_GT(other, r.cost - 1e-9 * (1.0 + std::abs(r.cost))) << seed;
    }
    for (const auto& u : p.inputs()) active += u(0) > 0.3 - 1e-6 || u(0) < -0.4 + 1e-6 ? 1 : 0;
  }
  EXPECT_GT(active, 50);
}

TEST(HorizonProgramme, AWarmStartTakesFewerIterations) {
  Programme p = mass(40);
  const ProgrammeResult cold = p.solve(Programme::State::Zero());
  const ProgrammeResult warm = p.solve(Programme::State::Constant(1e-4), {}, true);
  EXPECT_EQ(warm.end, ProgrammeEnd::kSolved);
  EXPECT_LT(warm.iterations, cold.iterations);
}

/// A soft bound is a hard one with a slack that costs: found as such by an input that does nothing else.
TEST(HorizonProgramme, SoftBoundsGiveWayAsTheirExcessCosts) {
  for (const double give : {1e-3, 0.1, 5.0}) {
    // Pulled beyond 0.3 at the end: x1 = u, cost 1/2 (x1 - 1)^2 + 1/2 eps u^2.
    Programme p(1);
    Programme::Stage& s = p.stages[0];
    s.B(0, 0) = 1.0;
    s.R(0, 0) = 1e-9;
    Programme::Stage& end = p.stages[1];
    end.Q(0, 0) = 1.0;
    end.q(0) = -1.0;
    end.x_high(0) = 0.3;
    end.x_give(0) = give;
    const ProgrammeResult r = p.solve(Programme::State::Zero(), {.tolerance = 1e-11});
    ASSERT_EQ(r.end, ProgrammeEnd::kSolved) << give;
    // d/dx: x - 1 + (x - 0.3) / give = 0.
    const double expected = (give + 0.3) / (give + 1.0);
    EXPECT_NEAR(p.states()[1](0), expected, 1e-8) << give;
    const double excess = expected - 0.3;
    EXPECT_NEAR(r.cost, 0.5 * expected * expected - expected + 0.5 * excess * excess / give, 1e-8) << give;
  }
}

TEST(HorizonProgramme, AStartBeyondASoftBoundIsNoDeadEnd) {
  Programme hard = mass(10), soft = mass(10);
  const Programme::State beyond(2.0, 0.0, 0.0, 0.0);
  ASSERT_NE(hard.solve(beyond).end, ProgrammeEnd::kSolved);
  for (Programme::Stage& s : soft.stages) s.x_give(0) = 1e-3;
  const ProgrammeResult r = soft.solve(beyond, {.iterations = 60, .tolerance = 1e-8});
  EXPECT_EQ(r.end, ProgrammeEnd::kSolved);
  EXPECT_LT(std::abs(soft.states().back()(0)), 2.0);
  EXPECT_GT(soft.states()[1](0), soft.stages[1].x_high(0));
  // Where the bound is not touched it makes no difference.
  const Programme::State inside(0.01, 0.0, 0.0, 0.0);
  ASSERT_EQ(hard.solve(inside, {.tolerance = 1e-10}).end, ProgrammeEnd::kSolved);
  ASSERT_EQ(soft.solve(inside, {.tolerance = 1e-10}).end, ProgrammeEnd::kSolved);
  for (std::size_t k = 0; k < hard.inputs().size(); ++k)
    EXPECT_NEAR((hard.inputs()[k] - soft.inputs()[k]).norm(), 0.0, 1e-7);
}

TEST(HorizonProgramme, SaysWhatCannotBe) {
  Programme p = mass(10);
  EXPECT_NE(p.solve(Programme::State(2.0, 0.0, 0.0, 0.0)).end, ProgrammeEnd::kSolved);  // beyond the bound, far from it
  EXPECT_EQ(p.solve(Programme::State::Constant(kNaN)).end, ProgrammeEnd::kInfeasible);
  EXPECT_EQ(mass(10).solve(Programme::State::Zero(), {.iterations = 2}).end, ProgrammeEnd::kIterationLimit);
}

}  // namespace
}  // namespace veridyn::numerics
