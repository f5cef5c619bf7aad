#include "veridyn/aircraft/export/trial_flight.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/core/constants.hpp"

namespace veridyn::aircraft {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TrialFlight flown(const Subject& s, double airspeed = 20.0) {
  return fly_trial(complete_subject(s, s, nullptr, {airspeed, 1.2, "of the test"}));
}

const FlownMode& mode_of(const TrialFlight& trial, Mode mode) {
  const auto at = std::ranges::find(trial.modes, mode, [](const FlownMode& m) { return m.linear.mode; });
  EXPECT_NE(at, trial.modes.end()) << words_of(mode);
  return *at;
}

TEST(TrialFlight, EveryModeOfAStableAircraftDoesWhatTheModelSays) {
  const TrialFlight trial = flown(builtin_subject("unatrap"));
  ASSERT_TRUE(trial.trim.usable()) << trial.trim.message();
  EXPECT_TRUE(trial.as_predicted()) << ::testing::PrintToString(trial_lines(trial));
  EXPECT_GE(trial.modes.size(), 4u);
  for (const FlownMode& mode : trial.modes) {
    EXPECT_EQ(mode.verdict, ModeVerdict::kAsPredicted) << words_of(mode.linear.mode);
    EXPECT_FALSE(mode.surface.empty());
  }
}

// With Cm_alpha of the wrong sign the nose goes away from the trim, in flight as in the model.
TEST(TrialFlight, AnUnstableAircraftIsSaidToBeAndFliesSo) {
  Subject s = builtin_subject("unatrap");
  CoefficientModel& Cm = s.model.at(Coefficient::kCm);
  Cm.values[1] = 1.5;
  ASSERT_EQ(Cm.terms[1].expression, "alpha");
  const TrialFlight trial = flown(s);
  ASSERT_TRUE(trial.trim.usable()) << trial.trim.message();
  EXPECT_FALSE(trial.unstable().empty());
  const auto growing = std::ranges::max_element(trial.modes, {}, &FlownMode::growth);
  EXPECT_GT(growing->growth, 0.1);
  EXPECT_EQ(growing->verdict, ModeVerdict::kAsPredicted) << growing->growth << " " << growing->linear.s.real();
  EXPECT_EQ(growing->surface, "elevator");
}

// A kink of the model at the trim: its tangent on one side says one thing, the flight another.
TEST(TrialFlight, AMotionThatIsNotWhatTheTangentSaysIsNamed) {
  Subject s = builtin_subject("unatrap");
  const TrialFlight before = flown(s);
  CoefficientModel Cm = s.model.at(Coefficient::kCm);
  const double alpha = before.trim.alpha;
  Cm.terms.push_back(parse_term("spline(alpha, " + std::to_string(alpha) + ", 1)", "test"));
  Cm.values.push_back(6.0);
  s.model.set(Cm);
  const TrialFlight trial = flown(s);
  ASSERT_TRUE(trial.trim.usable()) << trial.trim.message();
  EXPECT_FALSE(trial.as_predicted()) << ::testing::PrintToString(trial_lines(trial));
  EXPECT_THAT(trial_lines(trial), ::testing::Contains(HasSubstr("but flown it")));
}

TEST(TrialFlight, WhatCannotFlyLevelIsSaidWithTheReason) {
  Subject s = builtin_subject("unatrap");
  s.propulsion.polynomial = {{.throttle_power = 1, .airspeed_power = 0, .value = 1.0}};
  const TrialFlight trial = flown(s);
  EXPECT_FALSE(trial.as_predicted());
  EXPECT_TRUE(trial.modes.empty());
  EXPECT_THAT(trial_lines(trial), ElementsAre(HasSubstr("not trimmed at 20 m/s and 214 m: level flight at 20 m/s")));
}

// Without a rudder an asymmetry takes bank: it is flown without, and said.
TEST(TrialFlight, AnAsymmetryThatNoRudderHoldsIsLeftOutOfTheFlight) {
  Subject s = builtin_subject("thor");
  for (const Coefficient c : {Coefficient::kCY, Coefficient::kCl, Coefficient::kCn}) {
    s.model.at(c).values.back() = 0.0;
    ASSERT_TRUE(s.model.at(c).terms.back().uses(AeroVariable::kDr));
  }
  s.model.at(Coefficient::kCn).values[0] = 0.0005;
  const TrialFlight trial = flown(s);
  ASSERT_TRUE(trial.trim.usable()) << trial.trim.message();
  EXPECT_TRUE(trial.without_asymmetry);
  EXPECT_TRUE(trial.as_predicted()) << ::testing::PrintToString(trial_lines(trial));
  EXPECT_THAT(trial_lines(trial)[0], HasSubstr("which no rudder holds"));
}

// Without a rudder the Dutch roll is followed after the aileron.
TEST(TrialFlight, AModeIsFollowedAfterTheSurfaceThatMovesItMost) {
  Subject s = builtin_subject("thor");
  const TrialFlight with = flown(s);
  ASSERT_FALSE(with.modes.empty()) << with.trim.message();
  EXPECT_EQ(mode_of(with, Mode::kDutchRoll).surface, "rudder");
  EXPECT_EQ(mode_of(with, Mode::kRoll).surface, "aileron");
  EXPECT_EQ(mode_of(with, Mode::kShortPeriod).surface, "elevator");
  for (const Coefficient c : {Coefficient::kCY, Coefficient::kCl, Coefficient::kCn}) s.model.at(c).values.back() = 0.0;
  const TrialFlight without = flown(s);
  ASSERT_FALSE(without.modes.empty()) << without.trim.message();
  EXPECT_EQ(mode_of(without, Mode::kDutchRoll).surface, "aileron");
}

TEST(TrialFlight, LinesNameTheModesWithWhatTheyDo) {
  const std::vector<std::string> lines = trial_lines(flown(builtin_subject("unatrap")));
  EXPECT_THAT(lines[0], HasSubstr("trimmed at 20 m/s and 214 m (of the test): alpha"));
  EXPECT_THAT(lines[1], HasSubstr("short period"));
  EXPECT_THAT(lines[1], HasSubstr("stable, and flies so"));
}

}  // namespace
}  // namespace veridyn::aircraft
