#include "veridyn/vehicle/identification/fit/sampled_input.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace veridyn::vehicle {
namespace {

/// x^2 at the whole numbers, which a cubic through neighbours meets exactly.
const std::vector<double>& squares() {
  static const std::vector<double> values{0.0, 1.0, 4.0, 9.0, 16.0, 25.0};
  return values;
}

TEST(SampledInput, IsExactForAParabolaInside) {
  const SampledInput input{squares(), 1.0};
  for (const double x : {1.0, 1.3, 2.5, 3.99}) {
    EXPECT_NEAR(input.at(x), x * x, 1e-12);
    EXPECT_NEAR(between(squares(), x), x * x, 1e-12);
  }
}

TEST(SampledInput, HasTheDerivativeOfItsPosition) {
  using Jet = ceres::Jet<double, 1>;
  const SampledInput input{squares(), 1.0};
  const Jet at = input.at(Jet(2.3, 0));
  EXPECT_NEAR(at.a, 2.3 * 2.3, 1e-12);
  EXPECT_NEAR(at.v(0), 4.6, 1e-12);
  EXPECT_NEAR(between(squares(), Jet(2.3, 0)).v(0), 4.6, 1e-12);
}

TEST(SampledInput, HoldsItsEndValuesOutside) {
  using Jet = ceres::Jet<double, 1>;
  const SampledInput input{squares(), 1.0};
  EXPECT_EQ(input.at(-3.0), 0.0);
  EXPECT_EQ(input.at(9.0), 25.0);
  EXPECT_EQ(input.at(Jet(9.0, 0)).v(0), 0.0);
  const std::vector<double> one{7.0};
  EXPECT_EQ((SampledInput{one, 1.0}.at(3.0)), 7.0);
}

}  // namespace
}  // namespace veridyn::vehicle
