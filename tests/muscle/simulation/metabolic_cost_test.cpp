#include "veridyn/muscle/simulation/metabolic_cost.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "veridyn/muscle/osim/builtin_models.hpp"

namespace veridyn::muscle {
namespace {

/// 1000 N, 0.1 m, 10 L0/s: 0.42388 kg.
const MusculotendonParameters<double> kThousandNewton{.max_isometric_force = 1000.0, .optimal_fiber_length = 0.1};

MuscleDetails moving_fiber(double activation, double length, double velocity, double active_length,
                           double active_force) {
  MuscleDetails d;
  d.activation = activation;
  d.fiber_length = length;
  d.fiber_velocity = velocity;
  d.active_length = active_length;
  d.active_force = active_force;
  return d;
}

TEST(MetabolicCost, ByUmbergerIsHeatAndWork) {
  const MetabolicOptions options;
  const double mass = 1059.7 * 1000.0 * 0.1 / 0.25e6;
  EXPECT_NEAR(muscle_mass(kThousandNewton, options), mass, 1e-15);
  // Shortening below L0, u > a: A = u. Worked by hand: 1.5 * 0.5^0.6 * (128 * 0.4 + 25) W/kg; v = -2/s, a fifth of
  // Vmax: min(50, 100) * 0.6 + 153 * 0.2 * 0.4.
  const MetabolicRate fast =
      metabolic_rate(kThousandNewton, moving_fiber(0.4, 0.09, -0.2, 0.95, 200.0), 0.5, 0.6, options);
  EXPECT_NEAR(fast.activation_and_maintenance, mass * 1.5 * std::pow(0.5, 0.6) * 76.2, 1e-12);
  EXPECT_NEAR(fast.shortening, mass * 1.5 * 0.25 * (50.0 * 0.6 + 30.6 * 0.4), 1e-12);
  EXPECT_NEAR(fast.work, 40.0, 1e-12);
  EXPECT_NEAR(fast.total, fast.activation_and_maintenance + fast.shortening + fast.work, 1e-12);
  // The slow fibres' part has a greatest rate.
  const MetabolicRate faster =
      metabolic_rate(kThousandNewton, moving_fiber(0.4, 0.09, -0.9, 0.95, 10.0), 0.5, 1.0, options);
  EXPECT_NEAR(faster.shortening, mass * 1.5 * 0.25 * 100.0, 1e-12);
  // Lengthening beyond L0, u < a: A = (u + a)/2.
  const MetabolicRate slow =
      metabolic_rate(kThousandNewton, moving_fiber(0.4, 0.12, 0.1, 0.8, 500.0), 0.2, 0.5, options);
  EXPECT_NEAR(slow.activation_and_maintenance, mass * 1.5 * std::pow(0.3, 0.6) * 89.0 * (0.4 + 0.6 * 0.8), 1e-12);
  EXPECT_NEAR(slow.shortening, mass * 1.5 * 0.3 * 0.8 * 1000.0 * 0.1, 1e-12);
  EXPECT_NEAR(slow.work, -50.0, 1e-12);
  EXPECT_EQ(slow.total, 0.0) << "more work goes in than heat comes out";
  // At rest a muscle heats a watt a kilogram.
  const MetabolicRate rest = metabolic_rate(kThousandNewton, moving_fiber(0.0, 0.1, 0.0, 1.0, 0.0), 0.0, 0.5, options);
  EXPECT_NEAR(rest.total, mass, 1e-15);
}

TEST(MetabolicCost, ByBhargavaIsHeatAndWork) {
  const MetabolicOptions options{.model = MetabolicModel::kBhargava2004};
  const double mass = muscle_mass(kThousandNewton, options), root = std::numbers::sqrt2 / 2.0;
  const double slow = 0.6 * root, fast = 0.4 * (1.0 - root);
  // u = 0.5; at 1.2 L0 maintenance is 0.6.
  const MetabolicRate rate =
      metabolic_rate(kThousandNewton, moving_fiber(0.4, 0.12, -0.3, 0.8, 200.0), 0.5, 0.6, options);
  EXPECT_NEAR(rate.activation_and_maintenance, mass * (40.0 * slow + 133.0 * fast + 0.6 * (74.0 * slow + 111.0 * fast)),
              1e-12);
  EXPECT_NEAR(rate.shortening, (0.16 * 320.0 + 0.18 * 200.0) * 0.3, 1e-12);
  EXPECT_NEAR(rate.work, 60.0, 1e-12);
  const MetabolicRate longer =
      metabolic_rate(kThousandNewton, moving_fiber(0.4, 0.04, 0.1, 0.8, 200.0), 0.5, 0.6, options);
  EXPECT_NEAR(longer.shortening, -0.157 * 200.0 * 0.1, 1e-12);
  EXPECT_NEAR(longer.activation_and_maintenance,
              mass * (40.0 * slow + 133.0 * fast + 0.5 * (74.0 * slow + 111.0 * fast)), 1e-12);
}

TEST(MetabolicCost, OfASimulationIsThatOfItsRows) {
  const MusculoskeletalSystem system(load_model("arm").model());
  Progress progress;
  const MuscleTrajectory t =
      simulate_forward(system, default_start(system.model()), {ControlSignals(std::vector<double>(6, 0.3)), {}},
                       {.end = 0.2, .rate_Hz = 200.0}, progress);
  ASSERT_TRUE(t.usable());
  const MetabolicCost cost = metabolic_cost(system, t, {});
  ASSERT_EQ(cost.power.rows(), t.q.rows());
  ASSERT_EQ(cost.power.cols(), 6);
  EXPECT_GT(cost.power.minCoeff(), 0.0);
  // Held by its tendon the fibre's velocity is that of its length.
  const Eigen::Index row = 20;
  for (Eigen::Index m = 0; m < 6; ++m) {
    const double v = (t.fiber_length(row + 1, m) - t.fiber_length(row - 1, m)) * 100.0;
    const MuscleDetails d =
        system.muscles().details(m, 0.3, t.activation(row, m), t.fiber_length(row, m), t.path_length(row, m), 0.0);
    EXPECT_NEAR(d.fiber_velocity, v, 0.02 * std::abs(v) + 1e-3) << m;
    EXPECT_NEAR(cost.power(row, m), metabolic_rate(system.muscles().settings(m).musculotendon, d, 0.3, 0.5, {}).total,
                1e-9);
  }
  double energy = 0.0;
  for (Eigen::Index i = 0; i < t.q.rows(); ++i)
    energy += (i == 0 || i + 1 == t.q.rows() ? 0.5 : 1.0) * (cost.power.row(i).sum() + cost.basal) / 200.0;
  EXPECT_NEAR(cost.energy, energy, 1e-9 * energy);
}

}  // namespace
}  // namespace veridyn::muscle
