// Muscles against OpenSim 4.5.2: rates of random states, equilibria, and the muscles of a forward simulation.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/muscle/arm26_muscles.hpp"
#include "tests/muscle/reference_table.hpp"
#include "tests/support/integrate_adaptive.hpp"
#include "veridyn/muscle/actuator/muscle_group.hpp"
#include "veridyn/muscle/actuator/musculotendon.hpp"
#include "veridyn/numerics/piecewise_polynomial.hpp"

namespace veridyn::muscle {
namespace {

struct Kind {
  const char* name;
  MuscleCurves curves;
};
const std::array<Kind, 2>& kinds() {
  static const std::array<Kind, 2> kKinds{{{"thelen", arm26_thelen()}, {"millard", MillardCurves{}}}};
  return kKinds;
}

std::map<std::string, Musculotendon<double>> arm(const MuscleCurves& curves) {
  std::map<std::string, Musculotendon<double>> muscles;
  for (const MuscleParameters& p : arm26_muscles(curves)) muscles.emplace(p.name, p);
  return muscles;
}

TEST(MusculotendonReference, RatesOfSixHundredStatesAreThoseOfOpenSim) {
  for (const Kind& kind : kinds()) {
    const std::string file = fmt::format("b2_arm26_muscle_rates_{}.csv", kind.name);
    const test::ReferenceTable t = test::read_reference("opensim/" + file);
    if (t.rows.empty()) GTEST_SKIP() << "no reference/opensim/" << file << " in the folder of others\' data";
    const std::map<std::string, Musculotendon<double>> muscles = arm(kind.curves);
    std::map<std::string, double> worst;
    std::size_t compared = 0;
    for (std::size_t i = 0; i < t.rows.size(); ++i) {
      if (t.text(i, "status") != "ok") continue;
      ++compared;
      const MuscleParameters p = arm26_muscle(t.text(i, "muscle"), kind.curves);
      const auto& m = p.musculotendon;
      const Musculotendon<double>& muscle = muscles.at(p.name);
      const double u = t.number(i, "excitation"), a = t.number(i, "activation_state");
      const double lM = t.number(i, "fiber_length_state_m"), lMT = t.number(i, "path_length_m");
      const MuscleDetails d = muscle.details(u, a, lM, lMT, t.number(i, "path_speed_m_s"));
      const double speed = m.max_contraction_velocity * m.optimal_fiber_length, F0 = m.max_isometric_force;
      const auto note = [&](const char* name, double ours, double unit) {
        const double e = std::abs(ours - t.number(i, name)) / unit;
        worst[name] = std::max(worst[name], e);
      };
      note("activation_rate_1_s", d.activation_rate, 1.0 / m.activation_time_constant);
      note("fiber_velocity_m_s", d.fiber_velocity, speed);
      note("pennation_rad", d.pennation, 1.0);
      note("pennation_rate_rad_s", d.pennation_rate, 1.0);
      note("tendon_length_m", d.tendon_length, m.tendon_slack_length);
      note("tendon_velocity_m_s", d.tendon_velocity, speed);
      note("tendon_force_N", d.tendon_force, F0);
      note("fiber_force_N", d.fiber_force, F0);
      note("active_fiber_force_N", d.active_force, F0);
      note("passive_fiber_force_N", d.passive_force, F0);
      note("active_fl_multiplier", d.active_length, 1.0);
      note("passive_force_multiplier", d.passive, 1.0);
      note("fv_multiplier", d.force_velocity, 1.0);
      note("fiber_stiffness_N_m", d.fiber_stiffness, F0 / m.optimal_fiber_length);
      note("tendon_stiffness_N_m", d.tendon_stiffness, F0 / m.tendon_slack_length);
    }
    EXPECT_EQ(compared, 600u);
    fmt::print("b2 {}:", kind.name);
    for (const auto& [name, error] : worst) fmt::print(" {} {:.1e}", name, error);
    fmt::print("\n");
    EXPECT_LT(worst["activation_rate_1_s"], 1e-6);
    EXPECT_LT(worst["fiber_velocity_m_s"], 1e-6);
    for (const auto& [name, error] : worst) EXPECT_LT(error, 1e-6) << kind.name << " " << name;
  }
}

TEST(MusculotendonReference, EquilibriumForcesAreThoseOfOpenSim) {
  for (const Kind& kind : kinds()) {
    const std::string file = fmt::format("b_arm26_equilibrium_{}.csv", kind.name);
    const test::ReferenceTable t = test::read_reference("opensim/" + file);
    if (t.rows.empty()) GTEST_SKIP() << "no reference/opensim/" << file << " in the folder of others\' data";
    const std::map<std::string, Musculotendon<double>> muscles = arm(kind.curves);
    double force = 0.0, length = 0.0;
    int most = 0;
    for (std::size_t i = 0; i < t.rows.size(); ++i) {
      const MuscleParameters p = arm26_muscle(t.text(i, "muscle"), kind.curves);
      const Musculotendon<double>& muscle = muscles.at(p.name);
      const auto e = muscle.equilibrium(t.number(i, "activation"), t.number(i, "path_length_m"));
      EXPECT_EQ(e.end, EquilibriumEnd::kFound);
      most = std::max(most, e.evaluations);
      force = std::max(force,
                       std::abs(e.tendon_force - t.number(i, "tendon_force_N")) / p.musculotendon.max_isometric_force);
      length = std::max(length, std::abs(e.fiber_length - t.number(i, "fiber_length_m")));
    }
    fmt::print("b {}: {} states, force {:.1e} F0, fibre {:.1e} m, at most {} evaluations\n", kind.name, t.rows.size(),
               force, length, most);
    EXPECT_LT(force, 1e-6);
    EXPECT_LT(length, 1e-7);
  }
}

std::vector<double> numbers(const test::ReferenceTable& t, const std::string& column) {
  std::vector<double> values;
  for (std::size_t i = 0; i < t.rows.size(); ++i) values.push_back(t.number(i, column));
  return values;
}

// Excitations of the three scenarios.
double excitation(int scenario, std::size_t k, double t) {
  if (scenario == 1) return 0.05;
  if (scenario == 2) {
    constexpr std::array<double, 6> kLate{0.05, 0.5, 0.5, 0.4, 0.4, 0.4};
    return t > 0.2 ? kLate[k] : 0.05;
  }
  constexpr std::array<double, 6> kBase{0.08, 0.10, 0.25, 0.15, 0.20, 0.08};
  constexpr std::array<double, 6> kFrequency{1.0, 1.3, 1.7, 2.1, 2.5, 3.1};
  const double pi = std::acos(-1.0);
  return kBase[k] + 0.04 * std::sin(2.0 * pi * kFrequency[k] * t + static_cast<double>(k) * pi / 3.0);
}

TEST(MusculotendonReference, MusclesDrivenByRecordedPathsFollowOpenSimForASecond) {
  for (const Kind& kind : kinds())
    for (int scenario = 1; scenario <= 3; ++scenario) {
      const std::string file = fmt::format("c_arm26_forward_{}_s{}.csv", kind.name, scenario);
      const test::ReferenceTable t = test::read_reference("opensim/" + file);
      if (t.rows.empty()) GTEST_SKIP() << "no reference/opensim/" << file << " in the folder of others\' data";
      const std::vector<double> time = numbers(t, "time_s");
      double length = 0.0, force = 0.0, activation = 0.0;
      std::size_t k = 0;
      for (const MuscleParameters& p : arm26_muscles(kind.curves)) {
        const Musculotendon<double> muscle(p);
        const std::vector<double> path = numbers(t, p.name + "_path_length_m");
        const auto lMT = numerics::PiecewisePolynomial::simm_spline(time, path);
        Eigen::VectorXd x(2);
        x << t.number(0, p.name + "_activation"), t.number(0, p.name + "_fiber_length_m");
        // From row to row, so that excitation steps and rows coincide with step ends.
        for (std::size_t i = 1; i < t.rows.size(); ++i) {
          const double from = time[i - 1], to = time[i], middle = 0.5 * (from + to);
          const auto rates = [&](double s, const Eigen::VectorXd& y, Eigen::VectorXd& rate) {
            const double u = excitation(scenario, k, scenario == 2 ? middle : s);
            const auto r = muscle.rates(u, y(0), y(1), lMT.evaluate(s).value, 0.0);
            rate << r.activation_rate, r.fiber_velocity;
          };
          const auto end = numerics::integrate_adaptive(
              rates, x, from, to, {.absolute_tolerance = 1e-11, .relative_tolerance = 1e-10, .first_step = 1e-4});
          ASSERT_TRUE(end.usable());
          x = end.state;
          activation = std::max(activation, std::abs(x(0) - t.number(i, p.name + "_activation")));
          length = std::max(length, std::abs(x(1) - t.number(i, p.name + "_fiber_length_m")));
          force = std::max(
              force, std::abs(muscle.force(0.0, x(0), x(1), path[i], 0.0) - t.number(i, p.name + "_tendon_force_N")));
        }
        ++k;
      }
      fmt::print("c {} s{}: activation {:.1e}, fibre {:.1e} m, force {:.1e} N\n", kind.name, scenario, activation,
                 length, force);
      EXPECT_LT(activation, 1e-6) << file;
      EXPECT_LT(length, 1e-6) << file;
      EXPECT_LT(force, 0.1) << file;
    }
}

}  // namespace
}  // namespace veridyn::muscle
