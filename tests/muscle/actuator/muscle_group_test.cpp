#include "veridyn/muscle/actuator/muscle_group.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/muscle/actuator/muscle_variants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/muscle/model/simulation_jet.hpp"

namespace veridyn::muscle {
namespace {

TEST(MuscleGroup, GivesEachMuscleWhatItGivesAlone) {
  std::mt19937_64 generator(2);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<MuscleParameters> muscles;
  for (int repeat = 0; repeat < 3; ++repeat)
    for (const test::Variant& v : test::variants()) {
      muscles.push_back(test::parameters_of(v, uniform(generator) < 0.5 ? "TRIlong" : "TRImed"));
      muscles.back().name += std::to_string(muscles.size());
    }
  const MuscleGroup<double> group(muscles);
  const std::size_t n = group.size();
  std::vector<double> u(n), a(n), lM(n), lMT(n), vMT(n), a_rate(n), velocity(n), force(n), only_force(n), event(2 * n);
  std::vector<RigidTendonForces> rigid(n);
  for (int trial = 0; trial < 50; ++trial) {
    for (std::size_t i = 0; i < n; ++i) {
      const auto& p = muscles[i].musculotendon;
      u[i] = uniform(generator);
      a[i] = uniform(generator);
      lM[i] = p.optimal_fiber_length * (0.3 + 1.3 * uniform(generator));
      lMT[i] = p.tendon_slack_length * (0.99 + 0.06 * uniform(generator)) + lM[i] * 0.97;
      vMT[i] = uniform(generator) - 0.5;
    }
    group.rates({u, a, lM, lMT, vMT}, {a_rate, velocity, force});
    group.tendon_forces({u, a, lM, lMT, vMT}, only_force);
    group.events({u, a, lM, lMT, vMT}, event);
    group.rigid_forces(1.0, lMT, vMT, rigid);
    for (std::size_t i = 0; i < n; ++i) {
      static std::vector<Musculotendon<double>> alone(muscles.begin(), muscles.end());
      const auto r = alone[i].rates(u[i], a[i], lM[i], lMT[i], vMT[i]);
      EXPECT_EQ(a_rate[i], r.activation_rate);
      EXPECT_EQ(velocity[i], r.fiber_velocity) << muscles[i].name;
      EXPECT_EQ(force[i], r.tendon_force);
      EXPECT_EQ(only_force[i], r.tendon_force);
      EXPECT_EQ(rigid[i].active, alone[i].rigid_forces(1.0, lMT[i], vMT[i]).active);
      const MuscleDetails d = alone[i].details(u[i], a[i], lM[i], lMT[i], vMT[i]);
      EXPECT_EQ(d.tendon_force, r.tendon_force);
      if (!muscles[i].rigid_tendon) {
        EXPECT_NEAR(event[2 * i + 1], d.tendon_length - muscles[i].musculotendon.tendon_slack_length, 1e-15);
        // Along the tendon, the fibre's forces balance the tendon's unless the fibre is held, the velocity of an
        // undamped De Groote muscle is at its limit, or Schutte's fibre would have to push.
        const bool runaway =
            std::holds_alternative<DeGrooteFregly2016Curves>(muscles[i].curves) && std::abs(d.fiber_velocity) > 1e9;
        const bool pushes = std::holds_alternative<SchutteCurves>(muscles[i].curves) &&
                            d.tendon_force < d.passive_force * std::cos(d.pennation);
        if (d.limit != MuscleLimit::kShortestFiber && d.activation * d.active_length > 1e-6 && !runaway && !pushes) {
          EXPECT_NEAR(d.fiber_force * std::cos(d.pennation), d.tendon_force,
                      1e-9 * 800.0 * (1.0 + std::abs(d.force_velocity)))
              << muscles[i].name;
        }
      }
    }
  }
  const auto jets = group.with<SimulationJet>(
      std::vector<MusculotendonParameters<SimulationJet>>(n, muscles[0].musculotendon.cast<SimulationJet>()));
  EXPECT_EQ(jets.size(), n);
}

TEST(MuscleGroup, RejectsWrongNumbersNamingMuscleAndElement) {
  const auto message = [](const auto& change) {
    MuscleParameters p = arm26_muscle("BRA", arm26_thelen());
    change(p);
    try {
      const MuscleGroup<double> group(std::vector<MuscleParameters>{p});
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message([](MuscleParameters& p) { p.musculotendon.tendon_slack_length = -0.1; }),
            "muscle BRA: tendon_slack_length is -0.1; must be > 0");
  EXPECT_EQ(message([](MuscleParameters& p) { p.musculotendon.max_isometric_force = std::nan(""); }),
            "muscle BRA: max_isometric_force is nan; must be > 0");
  EXPECT_EQ(message([](MuscleParameters& p) { p.curves = ThelenCurves{.tendon_strain = 0.0}; }),
            "muscle BRA: FmaxTendonStrain is 0; must be > 0");
  EXPECT_NE(message([](MuscleParameters& p) { p.minimum_activation = 2.0; }), "");
  EXPECT_NE(message([](MuscleParameters& p) { p.curves = MillardCurves{.tendon_curviness = 3.0}; }), "");
  EXPECT_NE(message([](MuscleParameters& p) { p.musculotendon.pennation_angle_at_optimal = 1.6; }), "");
  EXPECT_EQ(message([](MuscleParameters&) {}), "");
  const MuscleGroup<double> arm(arm26_muscles(arm26_thelen()));
  std::vector<double> u(6, 0.1);
  arm.check_excitations(u);
  u[4] = std::nan("");
  try {
    arm.check_excitations(u);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "muscle BICshort: its excitation is nan; must be a finite number");
  }
}

}  // namespace
}  // namespace veridyn::muscle
