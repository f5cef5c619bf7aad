#include "veridyn/vehicle/tyre/four_linear_tyres.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/vehicle/tyre/four_tyres_cases.hpp"

namespace veridyn::vehicle {
namespace {

TEST(FourLinearTyres, AreTheTyresOneByOneToTheLastBit) {
  std::mt19937_64 random(41);
  const auto between = [&](double a, double b) { return std::uniform_real_distribution(a, b)(random); };
  for (const bool limited : {false, true}) {
    PerWheel<LinearTyre<double>> tyres;
    for (LinearTyre<double>& t : tyres) {
      t = {.stiffness = between(3e4, 1e5), .slip_stiffness = between(5e4, 2e5)};
      if (limited && &t != &tyres[1]) t.mu = between(0.3, 1.2);
    }
    testing::expect_tyres_one_by_one(tyres, random, 0.0, 0.0);
  }
}

}  // namespace
}  // namespace veridyn::vehicle
