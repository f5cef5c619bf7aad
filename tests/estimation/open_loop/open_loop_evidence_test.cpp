#include "veridyn/estimation/open_loop/open_loop_evidence.hpp"

#include <gtest/gtest.h>

#include "veridyn/estimation/judgement/check.hpp"

namespace veridyn::estimation {
namespace {

OpenLoop with_state(double horizon_s, double normalised_rmse, std::size_t held) {
  OpenLoop open_loop;
  open_loop.inputs = "steering and speed";
  open_loop.times.duration_s = 60.0;
  open_loop.windows.resize(3);
  open_loop.states.push_back({.name = "yaw_rate",
                              .unit = "deg/s",
                              .normalised_rmse = normalised_rmse,
                              .horizon_s = horizon_s,
                              .windows = 3,
                              .held = held});
  return open_loop;
}

const OpenLoopHorizon kHorizon{.period_s = 2.0, .motion = "yaw oscillation"};

TEST(OpenLoopEvidence, GradesTheHorizonByPeriodsAndError) {
  const auto outcome = [](double horizon_s, double rmse, std::size_t held) {
    return open_loop_horizon(with_state(horizon_s, rmse, held), kHorizon)->outcome;
  };
  EXPECT_EQ(outcome(21.0, 0.9, 0), Outcome::kPassed);
  EXPECT_EQ(outcome(19.0, 0.9, 0), Outcome::kCare);
  EXPECT_EQ(outcome(5.0, 0.9, 0), Outcome::kFailed);
  EXPECT_EQ(outcome(5.0, 0.2, 0), Outcome::kCare) << "a small error leaves narrow bands";
  EXPECT_EQ(outcome(5.0, 0.9, 2), Outcome::kNotVerified) << "most windows held to their end";
  EXPECT_FALSE(open_loop_horizon(OpenLoop(), kHorizon).has_value());
}

TEST(OpenLoopEvidence, SaysWhatLeftAndWhatToDo) {
  OpenLoop open_loop = with_state(5.0, 0.9, 0);
  open_loop.states.push_back({.name = "accel_y", .unit = "m/s^2", .horizon_s = 30.0, .windows = 3});
  const Evidence row = *open_loop_horizon(open_loop, kHorizon);
  EXPECT_EQ(says(row),
            "integrated from steering and speed alone, the model leaves the 95 % band of yaw_rate after 5.0 s, and "
            "misses it by 0.90 times what the motion varies: 2.5 periods of the yaw oscillation");
  EXPECT_EQ(row.cause, Cause::kMissingTerm);
  EXPECT_EQ(row.limit, 3.0);
  EXPECT_EQ(open_loop_horizon(with_state(5.0, 0.2, 0), kHorizon)->cause, Cause::kNoise);
  OpenLoopHorizon in_gusts = kHorizon;
  in_gusts.air_known = false;
  EXPECT_EQ(open_loop_horizon(open_loop, in_gusts)->cause, Cause::kMissing);
  EXPECT_EQ(open_loop_horizon(with_state(21.0, 0.2, 0), kHorizon)->cause, Cause::kNone);
}

TEST(OpenLoopEvidence, ComparesWithTheMeanAndCountsWhatDiverged) {
  OpenLoop open_loop = with_state(5.0, 1.5, 0);
  open_loop.windows[1].diverged = true;
  const std::vector<Evidence> rows = open_loop_errors(open_loop, "50 rad/s");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].outcome, Outcome::kCare);
  EXPECT_EQ(rows[0].value, 1.5);
  EXPECT_EQ(rows[1].outcome, Outcome::kFailed);
  EXPECT_EQ(says(rows[1]), "1 of 3 windows left the range of the model (50 rad/s) open loop");
  EXPECT_TRUE(open_loop_errors(OpenLoop(), "").empty());
}

}  // namespace
}  // namespace veridyn::estimation
