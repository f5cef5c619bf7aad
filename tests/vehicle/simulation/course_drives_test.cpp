#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/vehicle/simulation/metric_value.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/deg_per_g.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/vehicle/simulation_study.hpp"

// Manoeuvres between cones and to the limit, driven by the built-in saloon as studies drive them.

namespace veridyn::vehicle {
namespace {

using testing::value;

SimulationRun saloon_run(const std::string& drive, const std::string& subject = "tyre = \"fiala\"\n") {
  const Study study = Study::parse(
      "[subject]\nkind = \"vehicle\"\nbuiltin = \"saloon\"\n" + subject + "[drive]\nmodel = \"four-wheel\"\n" + drive,
      "study.toml");
  Progress silent;
  const SimulationStudy read = read_simulation_study(study.root(), silent);
  study.root().finish();
  return run_simulation_study(read, silent);
}

constexpr const char* kObstacle = "manoeuvre = \"obstacle avoidance\"\npreview_time = 0.6\ndelay = 0.1\n";
constexpr const char* kSlalom = "manoeuvre = \"slalom\"\npreview_time = 0.7\ndelay = 0.1\n";

TEST(CourseDrives, ObstacleAvoidanceIsPassedSlowlyAndNotAtTheLimit) {
  const SimulationRun slow = saloon_run(std::string(kObstacle) + "speed = \"30 km/h\"\n");
  EXPECT_EQ(value(slow.metrics, "within_lanes"), 1.0);
  EXPECT_GT(value(slow.metrics, "lane_margin"), 0.02);
  EXPECT_NEAR(value(slow.metrics, "entry_speed"), 30.0 / 3.6, 1e-9);
  for (const double u : slow.trajectory.u) EXPECT_EQ(u, 30.0 / 3.6);  // held
  EXPECT_EQ(value(saloon_run(std::string(kObstacle) + "speed = \"90 km/h\"\n").metrics, "within_lanes"), 0.0);
}

TEST(CourseDrives, SlalomPassesAllConesSlowlyAndSwingsAlikeToBothSides) {
  const SimulationRun slow = saloon_run(std::string(kSlalom) + "speed = \"35 km/h\"\ncones = 10\n");
  EXPECT_EQ(value(slow.metrics, "cones_hit"), 0.0);
  EXPECT_EQ(value(slow.metrics, "cones_passed"), 10.0);
  EXPECT_NEAR(value(slow.metrics, "lowest_speed"), 35.0 / 3.6, 1e-9);
  // In the middle of the course a period of two cones has the same swing to the left as to the right.
  const VehicleTrajectory& t = slow.trajectory;
  double most = 0.0, least = 0.0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (t.x[i] < 40.0 + 4 * 18.0 || t.x[i] > 40.0 + 6 * 18.0) continue;
    most = std::max(most, t.r[i]);
    least = std::min(least, t.r[i]);
  }
  EXPECT_GT(most, 0.2);
  EXPECT_NEAR(-least, most, 0.01 * most);
  EXPECT_GT(value(saloon_run(std::string(kSlalom) + "speed = \"80 km/h\"\n").metrics, "cones_hit"), 0.0);
}

TEST(CourseDrives, RampSteerReachesTheLimitOfTheTyresAlikeToBothSides) {
  const std::string ramp = "manoeuvre = \"ramp steer\"\nspeed = \"100 km/h\"\nrate = \"0.5 deg/s\"\namplitude = ";
  const SimulationRun left = saloon_run(ramp + "\"6 deg\"\n"), right = saloon_run(ramp + "\"-6 deg\"\n");
  const double limit = value(left.metrics, "peak_lateral_acceleration");
  EXPECT_LT(limit, 0.95 * kGravity);
  EXPECT_GT(limit, 0.75 * kGravity);
  EXPECT_EQ(value(right.metrics, "peak_lateral_acceleration"), limit);
  EXPECT_EQ(value(right.metrics, "steer_at_peak"), -value(left.metrics, "steer_at_peak"));
  // Gentle turns are those of the linear model; the ramp lags, and the tyres saturate a little up to 4 m/s^2.
  const double gentle = deg_per_g(left.cornering->understeer_gradient);
  EXPECT_NEAR(value(left.metrics, "understeer_gradient_deg_per_g"), gentle, 0.25 * gentle);
  EXPECT_NEAR(value(left.metrics, "roll_gradient_deg_per_g"), deg_per_g(left.cornering->roll_gradient), 0.15);
}

TEST(CourseDrives, BrakingInATurnBeginsOnItsCircleAndLosesSpeedAsItsBrakesSay) {
  const std::string drive =
      "longitudinal = true\nmanoeuvre = \"braking in a turn\"\nspeed = \"72 km/h\"\ndeceleration = 3\n"
      "brake_time = 12\n";
  const SimulationRun left = saloon_run(drive + "radius = 100\n"), right = saloon_run(drive + "radius = -100\n");
  const auto& m = left.metrics;
  EXPECT_NEAR(value(m, "initial_lateral_acceleration"), 400.0 / 100.0, 0.15);
  // The torque brakes the wheels' spin as well, and rolling, drag and cornering add to it.
  EXPECT_GT(value(m, "deceleration"), 3.0 * 1500.0 / (1500.0 + 4.0 / 0.09));
  EXPECT_LT(value(m, "deceleration"), 3.6);
  // With the steering held an understeering car turns the tighter the slower it is.
  EXPECT_GT(value(m, "yaw_rate_of_circle_ratio_1.00s"), 1.05);
  const VehicleTrajectory& t = left.trajectory;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (t.time[i] >= 12.0) {
      EXPECT_EQ(t.steer[i], t.steer[1200]) << t.time[i];
    }
  }
  EXPECT_NEAR(value(right.metrics, "yaw_rate_ratio_1.00s"), value(m, "yaw_rate_ratio_1.00s"), 1e-9);
  EXPECT_NEAR(value(right.metrics, "sideslip_change_1.00s"), -value(m, "sideslip_change_1.00s"), 1e-9);
}

}  // namespace
}  // namespace veridyn::vehicle
