#include "veridyn/aircraft/simulation/autopilot.hpp"

#include <gtest/gtest.h>

#include "veridyn/aircraft/model/builtin_subjects.hpp"

namespace veridyn::aircraft {
namespace {

class AutopilotAtTrim : public ::testing::Test {
 protected:
  AutopilotAtTrim()
      : subject(builtin_subject("unatrap")),
        trim(find_trim(subject, {.airspeed = 20.0, .density = 1.2})),
        pilot(subject, trim, linearise(subject, trim), 100.0, 0.3, 0.5) {
    truth[Truth::kPosDown] = -100.0;
    truth[Truth::kPitch] = trim.theta;
    truth[Truth::kYaw] = 0.3;
    truth[Truth::kAirspeed] = 20.0;
    truth[Truth::kAlpha] = trim.alpha;
  }

  Subject subject;
  Trim trim;
  Autopilot pilot;
  TruthSample truth;
  Excitation none{{}};
};

TEST_F(AutopilotAtTrim, KeepsTheControlsOfTheTrim) {
  const auto command = pilot.command(0.0, 0.0025, truth, none);
  EXPECT_NEAR(command[0], trim.controls.de, 1e-9);
  EXPECT_NEAR(command[1], trim.controls.da, 1e-9);
  EXPECT_NEAR(command[2], trim.controls.dr, 1e-9);
  EXPECT_NEAR(command[3], trim.controls.throttle, 1e-9);
}

TEST_F(AutopilotAtTrim, AnswersSlownessByThrottleAndARollByTheAileron) {
  truth[Truth::kAirspeed] = 15.0;
  truth[Truth::kRoll] = 0.2;
  auto command = pilot.command(0.0, 0.0025, truth, none);
  for (int k = 0; k < 400; ++k) command = pilot.command(0.0025 * k, 0.0025, truth, none);
  EXPECT_GT(command[3], trim.controls.throttle);
  const double roll_by_aileron = linearise(subject, trim).B(3, 1);
  EXPECT_LT((command[1] - trim.controls.da) * roll_by_aileron, 0.0) << "rolls back";
}

TEST_F(AutopilotAtTrim, AddsTheExcitationToItsCommand) {
  const Excitation pulse({{.kind = ManoeuvreKind::kPulse,
                           .start = 0.0,
                           .surfaces = {Surface::kElevator},
                           .amplitude = {0.02},
                           .pulse = 1.0}});
  EXPECT_NEAR(pilot.command(0.5, 0.0025, truth, pulse)[0], trim.controls.de + 0.02, 1e-9);
}

}  // namespace
}  // namespace veridyn::aircraft
