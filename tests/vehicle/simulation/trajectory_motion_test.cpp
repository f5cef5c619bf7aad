#include "veridyn/vehicle/simulation/trajectory_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/vehicle/simulation_study.hpp"

namespace veridyn::vehicle {
namespace {

VehicleTrajectory driven(const std::string& model) {
  const Study study =
      Study::parse("[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n[drive]\nmodel = \"" + model +
                       "\"\nmanoeuvre = \"sine\"\namplitude = \"3 deg\"\nfrequency = \"0.5 Hz\"\n"
                       "speed = 20\nduration = 6\noutput_step = 0.005\n",
                   "s.toml");
  Progress progress;
  return run_simulation_study(read_simulation_study(study.root(), progress), progress).trajectory;
}

TEST(TrajectoryMotion, OfABicycleIsLevelWithItsAccelerations) {
  const VehicleTrajectory t = driven("bicycle");
  const auto samples = motion_samples(t, kGravity);
  ASSERT_EQ(samples.size(), t.size());
  for (std::size_t k = 0; k < t.size(); ++k) {
    EXPECT_NEAR(samples[k].force.y(), t.lateral_acceleration[k], 1e-12);
    EXPECT_NEAR(samples[k].force.z(), kGravity, 1e-12);
    EXPECT_EQ(samples[k].rate.z(), t.r[k]);
  }
}

TEST(TrajectoryMotion, AccelerationAgainstTheWorldIsThatOfThePath) {
  // Two independent ways: specific force and attitude, and the second derivative of x, y and heave.
  const VehicleTrajectory t = driven("four-wheel");
  const auto samples = motion_samples(t, kGravity);
  double largest = 0.0, off = 0.0;
  for (std::size_t k = 400; k + 2 < t.size(); ++k) {
    const double h = t.time[k + 1] - t.time[k];
    const auto second = [&](const std::vector<double>& v) { return (v[k + 1] - 2.0 * v[k] + v[k - 1]) / (h * h); };
    const Eigen::Vector3d path(second(t.x), second(t.y), second(t.heave));
    const Eigen::Vector3d world = samples[k].attitude * samples[k].force - Eigen::Vector3d(0.0, 0.0, kGravity);
    largest = std::max(largest, path.norm());
    off = std::max(off, (path - world).norm());
  }
  EXPECT_GT(largest, 3.0);
  EXPECT_LT(off, 2e-3 * largest);
}

}  // namespace
}  // namespace veridyn::vehicle
