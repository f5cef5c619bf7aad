#include "veridyn/vehicle/tyre/tir_writer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "veridyn/vehicle/tyre/tir_reader.hpp"

namespace veridyn::vehicle {
namespace {

SimpleMagicFormulaTyre<double> tyre() {
  SimpleMagicFormulaTyre<double> t;
  t.stiffness = 57000.0;
  t.slip_stiffness = 80000.0;
  t.mu = 0.93;
  t.C = 1.42;
  t.E = -0.4;
  t.nominal_load = 3600.0;
  return t;
}

/// The largest difference of the lateral force over friction times load, over slip angles up to 0.2 rad.
double lateral_difference(const SimpleMagicFormulaTyre<double>& t, double load) {
  const TirFile read = parse_tir(write_tir(t, {}), "written.tir");
  double largest = 0.0;
  for (double slip = -0.2; slip < 0.21; slip += 0.02) {
    const double given = t.forces(load, 0.0, slip, 0.0).Fy, there = read.tyre.forces(load, 0.0, slip, 0.0).Fy;
    largest = std::max(largest, std::abs(given - there) / (t.mu * load));
  }
  return largest;
}

TEST(TirWriter, WritesATyreThatTheReaderTakesForTheSame) {
  EXPECT_LT(lateral_difference(tyre(), 3600.0), 1e-9);
  // Stiffness in proportion to the load is 1e-6 off away from the nominal one.
  EXPECT_LT(lateral_difference(tyre(), 1800.0), 2e-6);
  EXPECT_LT(lateral_difference(tyre(), 6000.0), 5e-6);
}

TEST(TirWriter, KeepsAStiffnessThatGrowsLessThanTheLoad) {
  SimpleMagicFormulaTyre<double> t = tyre();
  t.stiffness_saturation = 0.7;
  for (const double load : {1500.0, 3600.0, 6500.0}) {
    EXPECT_LT(lateral_difference(t, load), 1e-9) << load;
    const TirFile read = parse_tir(write_tir(t, {}), "written.tir");
    EXPECT_NEAR(read.tyre.cornering_stiffness(load) / t.cornering_stiffness(load), 1.0, 1e-9) << load;
  }
}

// mu/(1 + p (x - 1)) against mu (1 - p (x - 1)): p^2 (x - 1)^2 apart.
TEST(TirWriter, HasTheFrictionsSlopeOverLoad) {
  SimpleMagicFormulaTyre<double> t = tyre();
  t.mu_load = 0.1;
  EXPECT_LT(lateral_difference(t, 1.2 * 3600.0), 0.1 * 0.1 * 0.2 * 0.2 * 1.1);
}

TEST(TirWriter, HasTheSlipStiffnessAndTheWheelsNumbers) {
  const TirFile read = parse_tir(write_tir(tyre(), {.radius = 0.31, .vertical_stiffness = 210000.0}), "written.tir");
  const double slip = 1e-6;
  EXPECT_NEAR(read.tyre.forces(3600.0, slip, 0.0, 0.0).Fx / slip / 80000.0, 1.0, 1e-6);
  EXPECT_EQ(read.nominal_load, 3600.0);
  EXPECT_EQ(read.unloaded_radius, 0.31);
  EXPECT_EQ(read.vertical_stiffness, 210000.0);
  EXPECT_TRUE(read.unknown_keys.empty());
}

TEST(TirWriter, KeepsCommentsInTheirLine) {
  const std::string text = write_tir(tyre(), {.comments = {"front tyre of\n[MODEL]\nPKY1 = 3"}});
  EXPECT_NE(text.find("$ front tyre of [MODEL] PKY1 = 3\n"), std::string::npos);
  EXPECT_NO_THROW(static_cast<void>(parse_tir(text, "written.tir")));
}

}  // namespace
}  // namespace veridyn::vehicle
