#include "veridyn/aircraft/flying_qualities/derived_modes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/identification/signals/measured_coefficients.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::DerivedQuantity;
using ::testing::HasSubstr;

const Trim kFlown{.condition = {.airspeed = 20.0, .density = 1.2}, .alpha = 0.05};

/// An estimate that holds the subject's own values, each known to a share of itself.
estimation::Estimate estimate_of(const Subject& s, double share) {
  estimation::Estimate estimate;
  for (const Coefficient c : enumerators<Coefficient, kCoefficients>()) {
    const CoefficientModel& model = s.model.at(c);
    const std::vector<std::string> names = model.parameter_names();
    for (std::size_t i = 0; i < names.size(); ++i) {
      estimation::Parameter p;
      p.name = names[i];
      p.value = model.values[i];
      p.sigma = share * std::abs(p.value);
      estimate.parameters.push_back(p);
    }
  }
  Eigen::VectorXd variance(static_cast<Eigen::Index>(estimate.parameters.size()));
  for (Eigen::Index i = 0; i < variance.size(); ++i)
    variance(i) = std::pow(estimate.parameters[static_cast<std::size_t>(i)].sigma, 2);
  estimate.covariance = variance.asDiagonal();
  return estimate;
}

std::vector<CoefficientResult> identified_results(const Subject& s) {
  std::vector<CoefficientResult> results;
  for (const Coefficient c : enumerators<Coefficient, kCoefficients>()) {
    CoefficientResult result;
    result.coefficient = c;
    result.model = s.model.at(c);
    result.verdict = estimation::GroupVerdict::kIdentified;
    results.push_back(result);
  }
  return results;
}

const DerivedQuantity* find(const std::vector<DerivedQuantity>& all, const std::string& name) {
  const auto found = std::ranges::find(all, name, &DerivedQuantity::name);
  return found == all.end() ? nullptr : &*found;
}

// Against the same propagated by finite differences, one parameter after the other.
TEST(DerivedModes, HaveTheIntervalsOfTheirParameters) {
  const Subject s = builtin_subject("unatrap");
  constexpr double kShare = 0.03;
  const std::vector<DerivedQuantity> found =
      derived_modes(s, identified_results(s), estimate_of(s, kShare), kFlown, {}, 1);
  for (const Mode mode : {Mode::kShortPeriod, Mode::kDutchRoll}) {
    const auto damping_of = [&](const Subject& of) { return flight_modes(of, kFlown).modes[mode].value().damping(); };
    double variance = 0.0;
    for (const Coefficient c : enumerators<Coefficient, kCoefficients>()) {
      for (std::size_t i = 0; i < s.model.at(c).size(); ++i) {
        Subject high = s, low = s;
        high.model.at(c).values[i] *= 1.0 + kShare;
        low.model.at(c).values[i] *= 1.0 - kShare;
        variance += std::pow(0.5 * (damping_of(high) - damping_of(low)), 2);
      }
    }
    const DerivedQuantity* damping = find(found, std::string(kModeNames[mode]) + ".damping");
    ASSERT_NE(damping, nullptr);
    EXPECT_DOUBLE_EQ(damping->value, damping_of(s));
    const double half_width = 0.5 * (damping->high95 - damping->low95);
    EXPECT_NEAR(half_width, 1.96 * std::sqrt(variance), 0.15 * half_width) << words_of(mode);
  }
}

// An error of Jy makes Cm wrong in proportion, and what follows from Cm over Jy not at all.
TEST(DerivedModes, AreNotWidenedByAnInertiaThatCancels) {
  Subject s = builtin_subject("unatrap");
  estimation::Estimate estimate = estimate_of(s, 0.0);
  std::vector<CoefficientResult> results = identified_results(s);
  constexpr double kShare = 0.1;
  s.sigma.Jy = kShare * s.inertia->Jy;
  CoefficientResult& Cm = results[static_cast<std::size_t>(Coefficient::kCm)];
  Cm.body_sensitivity = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(Cm.model.size()), kBodyConstants);
  for (std::size_t i = 0; i < Cm.model.size(); ++i) {
    const double moves = kShare * Cm.model.values[i];
    Cm.body_sensitivity(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(BodyConstant::kJy)) = moves;
  }
  const auto first = std::ranges::find(estimate.parameters, "Cm_0", &estimation::Parameter::name);
  const Eigen::Index at = first - estimate.parameters.begin();
  estimate.covariance.block(at, at, Cm.body_sensitivity.rows(), Cm.body_sensitivity.rows()) =
      Cm.body_sensitivity * Cm.body_sensitivity.transpose();
  const auto width = [&](const std::vector<CoefficientResult>& of) {
    const std::vector<DerivedQuantity> found = derived_modes(s, of, estimate, kFlown, {}, 1);
    const DerivedQuantity* frequency = find(found, "short_period.frequency");
    return frequency->high95 - frequency->low95;
  };
  std::vector<CoefficientResult> apart = results;
  apart[static_cast<std::size_t>(Coefficient::kCm)].body_sensitivity = {};
  EXPECT_LT(width(results), 0.1 * width(apart));
}

TEST(DerivedModes, SayTheProbabilityOfALevel) {
  const Subject s = builtin_subject("unatrap");
  const std::vector<DerivedQuantity> found =
      derived_modes(s, identified_results(s), estimate_of(s, 0.2), kFlown, {.phase = FlightPhase::kA}, 1);
  const DerivedQuantity* level = find(found, "dutch_roll.level");
  ASSERT_NE(level, nullptr);
  EXPECT_THAT(level->note, HasSubstr("MIL-F-8785C, class I, category A: level 1 with probability"));
  EXPECT_GE(level->high95, level->low95);
}

// What is not excited leaves its modes out; a deflection's effect is in none.
TEST(DerivedModes, LeaveOutWhatIsNotExcited) {
  const Subject s = builtin_subject("unatrap");
  estimation::Estimate estimate = estimate_of(s, 0.03);
  const auto forget = [&](const std::string& name) {
    const auto p = std::ranges::find(estimate.parameters, name, &estimation::Parameter::name);
    ASSERT_NE(p, estimate.parameters.end()) << name;
    const Eigen::Index row = p - estimate.parameters.begin();
    estimate.covariance(row, row) = kNaN;
  };
  forget("Cm_de");
  EXPECT_NE(find(derived_modes(s, identified_results(s), estimate, kFlown, {}, 1), "short_period.damping"), nullptr);
  forget("Cm_q");
  const std::vector<DerivedQuantity> found = derived_modes(s, identified_results(s), estimate, kFlown, {}, 1);
  EXPECT_EQ(find(found, "short_period.damping"), nullptr);
  EXPECT_NE(find(found, "dutch_roll.damping"), nullptr);
}

// A spiral that may halve or double is said so: no end of its time.
TEST(DerivedModes, HaveNoLongestTimeWhereTheSignIsNotKnown) {
  const Subject s = builtin_subject("unatrap");
  const std::vector<DerivedQuantity> found =
      derived_modes(s, identified_results(s), estimate_of(s, 0.3), kFlown, {}, 1);
  const bool grows = find(found, "spiral.time_to_double") != nullptr;
  const DerivedQuantity* time = find(found, grows ? "spiral.time_to_double" : "spiral.time_to_half");
  ASSERT_NE(time, nullptr);
  EXPECT_GT(time->value, 0.0);
  EXPECT_GT(time->low95, 0.0);
  EXPECT_EQ(time->high95, kInfinity);
}

}  // namespace
}  // namespace veridyn::aircraft
