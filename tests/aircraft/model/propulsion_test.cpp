#include "veridyn/aircraft/model/propulsion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

// Beard & McLain 2012 eq. 4.15 and the propeller definition, worked out by hand here.
TEST(Propulsion, FollowsItsPublishedFormulas) {
  const Propulsion p = builtin_subject("skywalker_2013").propulsion;
  EXPECT_NEAR(p.load(0.6, 15.0, 1.225, 0.0).thrust, 0.5 * 1.225 * 0.33 * (18.0 * 18.0 - 225.0), 1e-12);
  EXPECT_DOUBLE_EQ(p.load(0.1, 15.0, 1.225, 0.0).thrust, 0.0);

  const Propulsion map = builtin_subject("skywalker_2013_mod").propulsion;
  const double omega = 800.0, n = omega / (2 * kPi), J = 15.0 / (n * 0.28);
  const auto load = map.load(0.0, 15.0, 1.225, omega);
  EXPECT_NEAR(load.thrust, 1.225 * n * n * std::pow(0.28, 4) * (0.1133 - 0.0740 * J - 0.1849 * J * J), 1e-12);
  EXPECT_NEAR(load.torque, -1.225 * n * n * std::pow(0.28, 5) * (0.0440 + 0.0059 * J - 0.0732 * J * J) / (2 * kPi),
              1e-13);
  EXPECT_DOUBLE_EQ(map.load(0.0, 15.0, 1.225, 0.0).thrust, 0.0);

  const Propulsion line = builtin_subject("unatrap").propulsion;
  EXPECT_NEAR(line.load(0.5, 20.0, 1.225, 0.0).thrust, 55.0 - 12.0, 1e-12);
}

}  // namespace
}  // namespace veridyn::aircraft
