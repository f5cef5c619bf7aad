#include "veridyn/vehicle/simulation_study.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/vehicle/described_car.hpp"

namespace veridyn::vehicle {
namespace {

using testing::kCar;
using testing::read_drive_study;

SimulationRun drive(const std::string& more, const std::string& subject = kCar) {
  const SimulationStudy study = read_drive_study(more, subject);
  Progress silent;
  return run_simulation_study(study, silent);
}

// Whatever the tyre, small slip is the same: all have the stiffness of the study.
TEST(SimulationStudy, AllTyresAgreeInGentleDriving) {
  const std::string gentle =
      "[drive]\nmodel = \"bicycle\"\nspeed = 20\nmanoeuvre = \"step steer\"\namplitude = 1e-4\nduration = 3\n";
  const double linear = drive(gentle).trajectory.r.back();
  for (const char* tyre : {"fiala", "magic formula"}) {
    const double r = drive(std::string("tyre = \"") + tyre + "\"\n" + gentle).trajectory.r.back();
    EXPECT_NEAR(r / linear, 1.0, 1e-3) << tyre;
  }
}

// The friction limit: no more lateral acceleration than mu g, up to the share of drag that the front wheels turn away.
TEST(SimulationStudy, FrictionLimitsTheLateralAcceleration) {
  const SimulationRun run = drive(
      "tyre = \"fiala\"\n[drive]\nmodel = \"bicycle\"\nspeed = 30\nmanoeuvre = \"step steer\"\namplitude = "
      "0.2\nduration = 3\n");
  const double limit = 0.9 * 9.80665;
  for (const double a : run.trajectory.lateral_acceleration) EXPECT_LE(std::abs(a), limit * (1.0 + 1e-9));
  EXPECT_GT(std::abs(run.trajectory.lateral_acceleration.back()), 0.8 * limit);
}

// With a share g of the stiffness the linear car is one with g C: steady yaw rate in closed form.
TEST(SimulationStudy, AfterAChangeOfGripTheCarIsTheSlipperyOne) {
  const SimulationRun run = drive(
      "[drive]\nmodel = \"linear bicycle\"\nspeed = 20\nmanoeuvre = \"step steer\"\namplitude = 0.02\nduration = 20\n"
      "[[drive.change]]\ntime = 10\ngrip = 0.5\n");
  const auto steady = [](double grip) {
    const double K = 1480.0 * (1.50 / (grip * 58000.0) - 1.14 / (grip * 65000.0)) / (2.0 * 2.64);
    return 20.0 * 0.02 / (2.64 + K * 400.0);
  };
  EXPECT_NEAR(run.trajectory.r[999], steady(1.0), 1e-9);
  EXPECT_NEAR(run.trajectory.r.back(), steady(0.5), 1e-9);
}

}  // namespace
}  // namespace veridyn::vehicle
