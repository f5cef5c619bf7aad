#include "veridyn/muscle/actuator/musculotendon.hpp"

#include <ceres/jet.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "tests/muscle/actuator/muscle_variants.hpp"
#include "tests/support/integrate_adaptive.hpp"

namespace veridyn::muscle {
namespace {

using Dual = ceres::Jet<double, 12>;

using test::parameters_of;
using test::Variant;
using test::variants;

// x: F0 L0 LS phi0 Vmax tau_act tau_deact u a lM lMT vMT
template <typename Scalar>
std::array<Scalar, 3> rates_of(const Variant& v, const std::array<Scalar, 12>& x) {
  const MusculotendonParameters<Scalar> p{x[0], x[1], x[2], x[3], x[4], x[5], x[6]};
  const auto settings = parameters_of(v);
  static std::map<std::string, CompiledCurves> compiled;  // tables are slow to make
  if (!compiled.contains(v.name)) compiled.emplace(v.name, compile_curves(settings));
  const CompiledCurves& curves = compiled.at(v.name);
  const auto r = Musculotendon<Scalar>(curves, settings, p).rates(x[7], x[8], x[9], x[10], x[11]);
  return {r.activation_rate, r.fiber_velocity, r.tendon_force};
}

TEST(Musculotendon, DerivativesOfTheRatesAreThoseOfCentralDifferences) {
  std::mt19937_64 generator(11);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (const Variant& v : variants()) {
    SCOPED_TRACE(v.name);
    for (int trial = 0; trial < 20; ++trial) {
      std::array<double, 12> x{798.52, 0.134, 0.143, 0.2, 10.0, 0.01, 0.04, 0.5 + 0.4 * uniform(generator),
                               0.0,    0.0,   0.0,   0.0};
      x[8] = 0.5 + 0.4 * uniform(generator);
      x[9] = 0.134 * (1.0 + 0.25 * uniform(generator));
      const double strain = 0.02 + 0.015 * uniform(generator);
      x[10] = v.rigid ? 0.143 + std::sqrt(x[9] * x[9] - std::pow(0.134 * std::sin(0.2), 2))
                      : 0.143 * (1.0 + strain) + std::sqrt(x[9] * x[9] - std::pow(0.134 * std::sin(0.2), 2));
      x[11] = 0.3 * uniform(generator);
      if (v.no_activation_dynamics) x[7] = std::clamp(x[7], 0.05, 0.95);
      std::array<Dual, 12> jets;
      for (int i = 0; i < 12; ++i) jets[i] = Dual(x[i], i);
      const auto exact = rates_of(v, jets);
      const auto plain = rates_of(v, x);
      const std::array<double, 3> unit{100.0, 1.34, 800.0};
      for (std::size_t o = 0; o < 3; ++o) EXPECT_NEAR(exact[o].a, plain[o], 1e-12 * unit[o]);
      for (std::size_t i = 0; i < 12; ++i) {
        const double h = 1e-6 * (std::abs(x[i]) + 0.01);
        auto up = x, down = x;
        up[i] += h;
        down[i] -= h;
        const auto f_up = rates_of(v, up), f_down = rates_of(v, down);
        for (std::size_t o = 0; o < 3; ++o) {
          const double difference = (f_up[o] - f_down[o]) / (2.0 * h);
          const double forward = (f_up[o] - plain[o]) / h, backward = (plain[o] - f_down[o]) / h;
          // At a corner of Thelen's curves there is no derivative to compare with.
          const double scale = unit[o] + std::abs(difference);
          if (std::abs(forward - backward) > 1e-2 * scale) continue;
          EXPECT_NEAR(exact[o].v[static_cast<int>(i)], difference, 2e-6 * scale) << "parameter " << i << " rate " << o;
        }
      }
    }
  }
}

TEST(Musculotendon, DerivativesOfTheEquilibriumAreThoseOfCentralDifferences) {
  for (const Variant& v : variants()) {
    SCOPED_TRACE(v.name);
    const MuscleParameters settings = parameters_of(v);
    const CompiledCurves curves = compile_curves(settings);
    const auto solve = [&]<typename Scalar>(const std::array<Scalar, 6>& x) {
      const MusculotendonParameters<Scalar> p{x[0], x[1], x[2], x[3], Scalar(10.0), Scalar(0.01), Scalar(0.04)};
      return Musculotendon<Scalar>(curves, settings, p).equilibrium(x[4], x[5]);
    };
    for (const double stretch : {0.83, 1.04, 1.21}) {
      const std::array<double, 6> x{798.52, 0.134, 0.143, 0.2, 0.37, 0.146 + 0.134 * stretch};
      std::array<ceres::Jet<double, 6>, 6> jets;
      for (int i = 0; i < 6; ++i) jets[i] = ceres::Jet<double, 6>(x[i], i);
      const auto exact = solve(jets);
      EXPECT_EQ(exact.end, EquilibriumEnd::kFound);
      EXPECT_NEAR(exact.fiber_length.a, solve(x).fiber_length, 1e-14);
      for (std::size_t i = 0; i < 6; ++i) {
        const double h = 1e-6 * x[i];
        auto up = x, down = x;
        up[i] += h;
        down[i] -= h;
        const auto f_up = solve(up), f_down = solve(down);
        const int k = static_cast<int>(i);
        const double dl = (f_up.fiber_length - f_down.fiber_length) / (2.0 * h);
        const double df = (f_up.tendon_force - f_down.tendon_force) / (2.0 * h);
        EXPECT_NEAR(exact.fiber_length.v[k], dl, 1e-6 * (1.0 + std::abs(dl))) << i;
        EXPECT_NEAR(exact.tendon_force.v[k], df, 1e-6 * (800.0 + std::abs(df))) << i;
      }
    }
  }
}

TEST(Musculotendon, EquilibriumIsAlwaysFound) {
  std::mt19937_64 generator(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  int found = 0, slack = 0, most = 0;
  double worst = 0.0;
  long evaluations = 0;
  const std::vector<Variant> all = variants();
  for (const Variant& v : all) {
    if (v.rigid) continue;
    const MuscleParameters settings = parameters_of(v);
    const CompiledCurves curves = compile_curves(settings);
    for (int trial = 0; trial < 15000; ++trial) {
      MusculotendonParameters<double> p = settings.musculotendon;
      p.optimal_fiber_length = 0.02 + 0.3 * uniform(generator);
      p.tendon_slack_length = p.optimal_fiber_length * std::pow(10.0, 2.0 * uniform(generator) - 1.0);
      p.pennation_angle_at_optimal = uniform(generator) < 0.3 ? 0.0 : 0.7 * uniform(generator);
      const double a = uniform(generator) < 0.1 ? 0.0 : uniform(generator);
      const double lMT = p.tendon_slack_length * (0.3 + uniform(generator)) +
                         p.optimal_fiber_length * 2.5 * uniform(generator) * std::cos(p.pennation_angle_at_optimal);
      const Musculotendon<double> muscle(curves, settings, p);
      const auto e = muscle.equilibrium(a, lMT);
      const double lM = e.fiber_length;
      ASSERT_TRUE(std::isfinite(lM)) << v.name;
      const double least = muscle.constants().minimum_length;
      const double residual = std::visit(
          [&](const auto& c) { return balance(c, muscle.constants(), std::max(a, 0.01), lM, lMT).value; }, curves);
      if (e.end == EquilibriumEnd::kFound) {
        ++found;
        // Rounding of the lengths times the stiffness of the tendon, and of strongly stretched fibres.
        const double stiffness = 1.0 + e.tendon_force / p.max_isometric_force;
        worst = std::max(worst, std::abs(residual) / stiffness);
        EXPECT_LT(std::abs(residual), 1e-10 * stiffness) << v.name << " a " << a << " lMT " << lMT;
        EXPECT_GE(lM, least);
      } else {
        ++slack;
        EXPECT_EQ(e.end, EquilibriumEnd::kSlackTendon);
        EXPECT_EQ(lM, least);
        EXPECT_GE(residual, 0.0);
      }
      most = std::max(most, e.evaluations);
      evaluations += e.evaluations;
    }
  }
  EXPECT_GT(found, 60000);
  EXPECT_GT(slack, 500);
  EXPECT_LT(most, 80);
  fmt::print("equilibria: {} found, {} slack, residual {:.1e}, {:.1f} evaluations, at most {}\n", found, slack, worst,
             static_cast<double>(evaluations) / (found + slack), most);
}

TEST(Musculotendon, EquilibriumFollowsPrintedValues) {
  struct Row {
    const char* name;
    double s, a, lM, phi, force;
  };
  // Bisection in an independent implementation, arm26's parameters; lMT = 1.01 LS + s L0 cos(phi0).
  for (const Row& r : {Row{"TRIlong", 1.0, 0.5, 0.132162437753, 0.212395790503, 390.141341459},
                       Row{"TRIlong", 1.1, 0.3, 0.145502722850, 0.192664961383, 242.976855151},
                       Row{"TRIlat", 0.85, 0.5, 0.095956440228, 0.186605296670, 292.013532193},
                       Row{"TRImed", 1.0, 1.0, 0.111760947443, 0.159969982924, 615.933360819},
                       Row{"BIClong", 1.0, 0.05, 0.115938840743, 0.0, 31.376139769},
                       Row{"BICshort", 1.0, 1.0, 0.127685370845, 0.0, 434.588202302},
                       Row{"BRA", 0.85, 0.5, 0.072240289490, 0.0, 469.577737779}}) {
    const MusculotendonParameters<double> p = arm26_muscle(r.name, arm26_thelen()).musculotendon;
    const double lMT =
        1.01 * p.tendon_slack_length + r.s * p.optimal_fiber_length * std::cos(p.pennation_angle_at_optimal);
    const Musculotendon<double> muscle(arm26_muscle(r.name, arm26_thelen()));
    const auto e = muscle.equilibrium(r.a, lMT);
    EXPECT_NEAR(e.fiber_length, r.lM, 1e-12);
    EXPECT_NEAR(e.tendon_force, r.force, 1e-8);
    const MuscleDetails d = muscle.details(r.a, r.a, e.fiber_length, lMT, 0.0);
    EXPECT_NEAR(d.pennation, r.phi, 1e-12);
    EXPECT_NEAR(d.fiber_velocity, 0.0, 1e-11);
  }
}

TEST(Musculotendon, PathsTooShortLeaveTheTendonSlackAndTheForceZero) {
  for (const Variant& v : variants()) {
    if (std::holds_alternative<DeprecatedThelenCurves>(v.curves)) continue;  // its tendon pulls at all lengths
    const Musculotendon<double> muscle(parameters_of(v));
    const auto e = muscle.equilibrium(0.5, 0.12);
    EXPECT_EQ(e.end, EquilibriumEnd::kSlackTendon) << v.name;
    const double force = muscle.force(0.5, 0.5, e.fiber_length, 0.12, -0.1);
    // De Groote's tendon goes on below zero, by at most 0.2 F0.
    const bool pushes = std::holds_alternative<DeGrooteFregly2016Curves>(v.curves) && !v.rigid;
    if (pushes) {
      EXPECT_GT(force, -0.2 * 798.52);
    } else {
      EXPECT_EQ(force, 0.0) << v.name;
    }
    EXPECT_EQ(muscle.details(0.5, 0.5, e.fiber_length, 0.12, 0.0).limit == MuscleLimit::kNone, false) << v.name;
  }
  const Musculotendon<double> muscle(arm26_muscle("BRA", arm26_thelen()));
  EXPECT_EQ(muscle.equilibrium(0.5, std::nan("")).end, EquilibriumEnd::kNotFinite);
  EXPECT_TRUE(std::isnan(muscle.equilibrium(0.5, std::nan("")).fiber_length));
}

TEST(Musculotendon, FiberIsHeldAtItsLeastLengthWhileItShortens) {
  for (const Variant& v : variants()) {
    if (v.rigid) continue;
    const Musculotendon<double> muscle(parameters_of(v));
    const double least = muscle.constants().minimum_length;
    const double slack_path = 0.9 * 0.143;
    EXPECT_EQ(muscle.rates(0.5, 0.5, least, slack_path, 0.0).fiber_velocity, 0.0) << v.name;
    EXPECT_EQ(muscle.rates(0.5, 0.5, 0.5 * least, slack_path, 0.0).fiber_velocity, 0.0) << v.name;
    const double long_path = 0.143 * 1.05 + least;
    EXPECT_GT(muscle.rates(0.5, 0.5, least, long_path, 0.0).fiber_velocity, 0.0) << v.name;
    const MuscleDetails d = muscle.details(0.0, 0.0, least, slack_path, 0.0);
    EXPECT_TRUE(std::isfinite(d.force_velocity) && std::isfinite(d.fiber_stiffness)) << v.name;
  }
}

TEST(Musculotendon, RatesAreContinuousInEveryInput) {
  for (const Variant& v : variants()) {
    const Musculotendon<double> muscle(parameters_of(v));
    const std::array<double, 5> centre{0.4, 0.5, 0.134, 0.143 * 1.02 + 0.1311, 0.0};
    const std::array<double, 5> reach{0.39, 0.45, 0.05, 0.02, 1.0};
    for (std::size_t i = 0; i < 5; ++i) {
      // Lipschitz: halving the step halves the greatest change, and a jump would not.
      const auto greatest_change = [&](int n) {
        double greatest = 0.0;
        MuscleRates<double> last{};
        for (int k = 0; k <= n; ++k) {
          auto x = centre;
          x[i] += reach[i] * (2.0 * k / n - 1.0);
          const auto r = muscle.rates(x[0], x[1], x[2], x[3], x[4]);
          if (k > 0)
            greatest = std::max({greatest, std::abs(r.fiber_velocity - last.fiber_velocity) / 1.34,
                                 std::abs(r.tendon_force - last.tendon_force) / 800.0,
                                 std::abs(r.activation_rate - last.activation_rate) / 100.0});
          last = r;
        }
        return greatest;
      };
      const double coarse = greatest_change(4000), fine = greatest_change(40000);
      EXPECT_LT(fine, 0.12 * coarse + 1e-12) << v.name << " input " << i;
    }
  }
}

// What the path puts in, less what tendon and passive fibre store, is what the active fibre and damping take.
TEST(Musculotendon, PowerIsStoredOrTakenByTheFiber) {
  for (const Variant& v : variants()) {
    if (v.rigid) continue;
    const MuscleParameters p = parameters_of(v);
    const Musculotendon<double> muscle(p);
    const double lM = 0.1553, h = 1e-6, vMT = 0.21;
    const double lMT =
        0.143 * 1.021 + std::sqrt(lM * lM - std::pow(0.134 * std::sin(p.musculotendon.pennation_angle_at_optimal), 2));
    const MuscleDetails d = muscle.details(0.6, 0.6, lM, lMT, vMT);
    const auto stored = [&](double s) {
      const MuscleDetails e = muscle.details(0.6, 0.6, lM + s * d.fiber_velocity, lMT + s * vMT, vMT);
      return e.fiber_energy + e.tendon_energy;
    };
    const double storing = (stored(h) - stored(-h)) / (2.0 * h);
    const double unit = std::visit([&](const auto& c) { return c.velocity_unit(0.6, 10.0); }, muscle.curves()) * 0.134;
    const double damping = p.musculotendon.max_isometric_force * v.damping * d.fiber_velocity / unit;
    const double taken = (d.active_force + damping) * d.fiber_velocity;
    EXPECT_GT(std::abs(d.fiber_velocity), std::holds_alternative<SchutteCurves>(v.curves) ? 0.005 : 0.01) << v.name;
    EXPECT_NEAR(d.tendon_force * vMT, storing + taken, 1e-6 * (std::abs(storing) + std::abs(taken))) << v.name;
  }
}

// A closed cycle of stretch and release: the integral of the power over time, with an adaptive integrator.
TEST(Musculotendon, WorkOverAStretchIsEnergyStoredPlusDissipated) {
  const MuscleParameters p = arm26_muscle("BIClong", arm26_thelen());
  const Musculotendon<double> muscle(p);
  const double rest = 0.2723 * 1.01 + 0.12;
  const auto path = [&](double t) { return rest + 0.02 * std::sin(5.0 * t); };
  const auto speed = [&](double t) { return 0.1 * std::cos(5.0 * t); };
  Eigen::VectorXd x(3);  // fibre, work of the path, work taken by the active fibre
  x << muscle.equilibrium(0.4, rest).fiber_length, 0.0, 0.0;
  const auto energy = [&](double lM, double lMT) {
    const MuscleDetails d = muscle.details(0.4, 0.4, lM, lMT, 0.0);
    return d.fiber_energy + d.tendon_energy;
  };
  const double before = energy(x(0), rest);
  const auto end = numerics::integrate_adaptive(
      [&](double t, const Eigen::VectorXd& y, Eigen::VectorXd& rate) {
        const MuscleDetails d = muscle.details(0.4, 0.4, y(0), path(t), speed(t));
        rate << d.fiber_velocity, d.tendon_force * speed(t), d.active_force * d.fiber_velocity;
      },
      x, 0.0, 1.0, {.absolute_tolerance = 1e-11, .relative_tolerance = 1e-10});
  ASSERT_TRUE(end.usable());
  const double stored = energy(end.state(0), path(1.0)) - before;
  EXPECT_NEAR(end.state(1), stored + end.state(2), 1e-8);
  EXPECT_GT(std::abs(end.state(1)), 0.01);
}

}  // namespace
}  // namespace veridyn::muscle
