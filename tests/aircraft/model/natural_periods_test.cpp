#include "veridyn/aircraft/model/natural_periods.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "tests/aircraft/model/modes.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/aircraft/model/trim.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

/// Of two states alone, by the derivatives of the whole aircraft that `linearise` has in other variables; none where
/// they are not stiff.
std::optional<double> period_of_two(const Eigen::Matrix<double, 8, 8>& A, int i, int j) {
  const double squared = A(i, i) * A(j, j) - A(i, j) * A(j, i);
  return squared > 0.0 ? std::optional(kFullTurn / std::sqrt(squared)) : std::nullopt;
}

AeroVariables<double> at_trim(const Trim& trim) {
  AeroVariables<double> v;
  v.alpha = trim.alpha;
  v.beta = trim.beta;
  v.de = trim.controls.de;
  v.da = trim.controls.da;
  v.dr = trim.controls.dr;
  v.Va = trim.condition.airspeed;
  return v;
}

// Vertical velocity is Va alpha and lateral velocity Va beta to second order in the angles (8 deg at trim).
TEST(NaturalPeriods, AreThoseOfTheTwoStatesInTheLinearisedAircraft) {
  int flown = 0;
  for (const std::string& name : builtin_subject_names()) {
    const Subject s = builtin_subject(name);
    if (!s.inertia || !s.model.unknown_parameters().empty()) continue;
    const Trim trim = find_trim(s, {.airspeed = 18.0, .density = 1.2});
    if (!trim.usable()) continue;
    ++flown;
    const Eigen::Matrix<double, 8, 8> A = linearise(s, trim).A;
    const NaturalPeriods periods = natural_periods(s, at_trim(trim), 1.2);
    const std::optional<double> short_period = period_of_two(A, 2, 4), dutch_roll = period_of_two(A, 1, 5);
    ASSERT_EQ(periods.short_period_s.has_value(), short_period.has_value()) << name;
    ASSERT_EQ(periods.dutch_roll_s.has_value(), dutch_roll.has_value()) << name;
    if (short_period) {
      EXPECT_NEAR(*periods.short_period_s, *short_period, 0.05 * *short_period) << name;
    }
    if (dutch_roll) {
      EXPECT_NEAR(*periods.dutch_roll_s, *dutch_roll, 0.05 * *dutch_roll) << name;
    }
  }
  EXPECT_GT(flown, 2);
}

// UnATRaP in level flight at 20 m/s: the short period of its whole motion, from the eigenvalues, is 0.70 s.
TEST(NaturalPeriods, AreNearTheEigenvaluesOfTheWholeMotion) {
  const Subject s = builtin_subject("unatrap");
  const Trim trim = find_trim(s, {.airspeed = 20.0, .density = 1.2});
  const auto longitudinal = testing::longitudinal_eigenvalues(linearise(s, trim));
  const double whole = kFullTurn / std::sqrt(std::abs(longitudinal[0] * longitudinal[1]));
  EXPECT_NEAR(natural_periods(s, at_trim(trim), 1.2).short_period_s.value(), whole, 0.1 * whole);
}

TEST(NaturalPeriods, AreMissingWhereTheAircraftIsUnstableOrNotKnown) {
  Subject s = builtin_subject("unatrap");
  AeroVariables<double> v;
  v.alpha = 0.05;
  v.Va = 20.0;
  EXPECT_TRUE(natural_periods(s, v, 1.2).short_period_s);
  Subject unstable = s;
  unstable.model.at(Coefficient::kCm).values[1] = 3.0;
  EXPECT_FALSE(natural_periods(unstable, v, 1.2).short_period_s);
  EXPECT_TRUE(natural_periods(unstable, v, 1.2).dutch_roll_s);
  s.model.at(Coefficient::kCn).values[1] = kNaN;
  EXPECT_FALSE(natural_periods(s, v, 1.2).dutch_roll_s);
  s.inertia.reset();
  EXPECT_FALSE(natural_periods(s, v, 1.2).short_period_s);
}

}  // namespace
}  // namespace veridyn::aircraft
