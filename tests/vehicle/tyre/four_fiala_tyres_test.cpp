#include "veridyn/vehicle/tyre/four_fiala_tyres.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/vehicle/tyre/four_tyres_cases.hpp"

namespace veridyn::vehicle {
namespace {

FialaTyre<double> any_tyre(std::mt19937_64& random) {
  const auto between = [&](double a, double b) { return std::uniform_real_distribution(a, b)(random); };
  return {.stiffness = between(3e4, 1e5),
          .slip_stiffness = between(5e4, 2e5),
          .mu = random() % 4 == 0 ? kInfinity : between(0.3, 1.2)};
}

TEST(FourFialaTyres, AreTheTyresOneByOne) {
  std::mt19937_64 random(31);
  for (int set = 0; set < 100; ++set) {
    PerWheel<FialaTyre<double>> tyres;
    for (FialaTyre<double>& t : tyres) t = any_tyre(random);
    testing::expect_tyres_one_by_one(tyres, random, 2e-15, 0.0);
  }
}

TEST(FourFialaTyres, MirrorAMirroredStateBitForBit) {
  std::mt19937_64 random(32);
  testing::expect_mirrored_bits(any_tyre(random), random);
}

TEST(FourFialaTyres, WithoutFrictionHaveNoForce) {
  const FialaTyre<double> ice{.mu = 0.0};
  const FourTyres<FialaTyre<double>> four({ice, ice, ice, ice});
  WheelArray<double> Fx, Fy;
  four.forces(WheelArray<double>::Constant(4000.0), WheelArray<double>(0.0, 0.1, 0.0, -0.1),
              WheelArray<double>(0.0, 0.0, 0.1, 0.2), 0.0, Fx, Fy);
  EXPECT_TRUE((Fx == 0.0).all()) << Fx.transpose();
  EXPECT_TRUE((Fy == 0.0).all()) << Fy.transpose();
}

}  // namespace
}  // namespace veridyn::vehicle
