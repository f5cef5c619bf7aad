#include "veridyn/vehicle/tyre/four_simple_magic_formula.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/vehicle/tyre/four_tyres_cases.hpp"

namespace veridyn::vehicle {
namespace {

using SimpleTyre = SimpleMagicFormulaTyre<double>;

SimpleTyre any_tyre(std::mt19937_64& random, bool bent) {
  const auto between = [&](double a, double b) { return std::uniform_real_distribution(a, b)(random); };
  return {.stiffness = between(3e4, 1e5),
          .slip_stiffness = between(5e4, 2e5),
          .mu = between(0.3, 1.2),
          .C = between(1.0, 2.0),
          .E = bent && random() % 4 != 0 ? between(-3.0, 1.0) : 0.0,
          .nominal_load = between(2000.0, 6000.0),
          .stiffness_saturation = random() % 2 == 0 ? 0.0 : between(0.1, 1.0),
          .mu_load = random() % 2 == 0 ? 0.0 : between(0.0, 0.3)};
}

TEST(FourSimpleMagicFormulaTyres, AreTheTyresOneByOne) {
  std::mt19937_64 random(21);
  for (int set = 0; set < 100; ++set) {
    PerWheel<SimpleTyre> tyres;
    for (SimpleTyre& t : tyres) t = any_tyre(random, set % 2 == 1);
    // Each function is within two units in the last place; far beyond the peak the curve takes a difference of two
    // angles, which costs a few more of friction times load.
    testing::expect_tyres_one_by_one(tyres, random, 1e-14, 1e-14);
  }
}

TEST(FourSimpleMagicFormulaTyres, MirrorAMirroredStateBitForBit) {
  std::mt19937_64 random(22);
  testing::expect_mirrored_bits(any_tyre(random, true), random);
  testing::expect_mirrored_bits(any_tyre(random, false), random);
}

TEST(FourSimpleMagicFormulaTyres, WithoutFrictionRollAsOneDoes) {
  const SimpleTyre ice{.mu = 0.0};
  const FourTyres<SimpleTyre> four({ice, ice, ice, ice});
  WheelArray<double> Fx, Fy;
  four.forces(WheelArray<double>::Constant(4000.0), WheelArray<double>(0.0, 0.1, 0.0, -0.1),
              WheelArray<double>(0.0, 0.0, 0.1, 0.2), 0.0, Fx, Fy);
  EXPECT_TRUE((Fx == 0.0).all()) << Fx.transpose();
  EXPECT_TRUE((Fy == 0.0).all()) << Fy.transpose();
}

}  // namespace
}  // namespace veridyn::vehicle
