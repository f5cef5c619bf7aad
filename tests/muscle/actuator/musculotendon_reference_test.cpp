// Muscles against OpenSim 4.5.2: rates of random states, which the program does not print (bench/peers has the rest).
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/muscle/arm26_muscles.hpp"
#include "tests/muscle/reference_table.hpp"
#include "veridyn/muscle/actuator/musculotendon.hpp"

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

}  // namespace
}  // namespace veridyn::muscle
