#include "veridyn/vehicle/model/spring_curve.hpp"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/refusal.hpp"

namespace veridyn::vehicle {
namespace {

/// A spring that stiffens in bump and towards the end of rebound, with its static force in it.
SpringCurve progressive() { return {{-0.09, -0.05, 0.02, 0.05, 0.08}, {900.0, 2100.0, 3500.0, 4400.0, 6500.0}}; }

TEST(SpringCurve, HasNoForceAtRestAndThatOfItsRowsLessThatAtRest) {
  const SpringCurve curve = progressive();
  EXPECT_EQ(curve.force(0.0), 0.0);
  for (std::size_t i = 0; i < curve.travels().size(); ++i) {
    EXPECT_NEAR(curve.force(curve.travels()[i]) - curve.force(curve.travels()[0]), curve.forces()[i] - 900.0, 1e-9);
  }
}

TEST(SpringCurve, OfTwoRowsIsAConstantRate) {
  const SpringCurve line({-0.1, 0.1}, {0.0, 5000.0});
  for (const double travel : {-0.4, -0.1, 0.0, 0.03, 0.1, 0.7}) {
    EXPECT_NEAR(line.force(travel), 25000.0 * travel, 1e-9) << travel;
    EXPECT_NEAR(line.rate(travel), 25000.0, 1e-9) << travel;
  }
}

// Where rows lie unevenly a cubic through them would dip; this one grows everywhere, and its slope does not jump.
TEST(SpringCurve, GrowsEverywhereWithAContinuousRate) {
  const SpringCurve curve({-0.1, -0.01, 0.0, 0.09, 0.1}, {-3000.0, -10.0, 0.0, 20.0, 4000.0});
  double before = curve.force(-0.2);
  for (int k = 1; k <= 4000; ++k) {
    const double travel = -0.2 + 1e-4 * k, now = curve.force(travel);
    EXPECT_GT(now, before) << travel;
    before = now;
  }
  for (const double row : curve.travels()) {
    EXPECT_NEAR(curve.rate(row - 1e-9), curve.rate(row + 1e-9), 1e-3 * curve.rate(row)) << row;
  }
}

TEST(SpringCurve, HasTheDerivativeThatItsRateSays) {
  using Jet = ceres::Jet<double, 1>;
  const SpringCurve curve = progressive();
  for (const double travel : {-0.3, -0.07, 0.0, 0.031, 0.079, 0.2}) {
    EXPECT_NEAR(curve.force(Jet(travel, 0)).v(0), curve.rate(travel), 1e-9 * curve.rate(travel)) << travel;
    const double difference = (curve.force(travel + 1e-6) - curve.force(travel - 1e-6)) / 2e-6;
    EXPECT_NEAR(curve.rate(travel), difference, 1e-3) << travel;  // rounding of forces of 1e3 N over 2e-6 m
  }
}

TEST(SpringCurve, FindsTheTravelOfAForceWithItsDerivative) {
  using Jet = ceres::Jet<double, 1>;
  const SpringCurve curve = progressive();
  for (const double travel : {-2.5, -0.09, -0.03, 0.0, 0.06, 0.5}) {
    const Jet found = curve.travel_at(Jet(curve.force(travel), 0));
    EXPECT_NEAR(found.a, travel, 1e-12);
    EXPECT_NEAR(found.v(0), 1.0 / curve.rate(travel), 1e-12);
  }
}

TEST(SpringCurve, ScalesLengthsAndForces) {
  const SpringCurve curve = progressive(), small = curve.scaled(0.2, 0.01);
  for (const double travel : {-0.2, -0.06, 0.03, 0.1})
    EXPECT_NEAR(small.force(0.2 * travel), 0.01 * curve.force(travel), 1e-10);
  EXPECT_TRUE(SpringCurve().scaled(2.0, 2.0).empty());
}

TEST(SpringCurve, RefusesWhatIsNoSpring) {
  const auto refusal = [](std::vector<double> travel, std::vector<double> force) {
    return why([&] { (void)SpringCurve(std::move(travel), std::move(force)); });
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal({0.0, 0.1}, {0.0}), "spring: has 2 travels and 1 forces");
  EXPECT_EQ(refusal({0.0}, {0.0}), "spring: needs at least two rows");
  EXPECT_EQ(refusal({0.0, 0.1, 0.2}, {0.0, 5.0, 5.0}),
            "spring: row 3 (0.2 m, 5 N): travel and force must be finite and increase");
  EXPECT_EQ(refusal({0.1, 0.0}, {0.0, 5.0}), "spring: row 2 (0 m, 5 N): travel and force must be finite and increase");
  EXPECT_NE(refusal({0.0, nan}, {0.0, 5.0}).find("row 2"), std::string::npos);
}

}  // namespace
}  // namespace veridyn::vehicle
