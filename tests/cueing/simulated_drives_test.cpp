// What a platform makes of forces, turns and slopes of a simulated car, each by itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/cueing/chain/cueing_chain.hpp"
#include "veridyn/cueing/washout/washout_design.hpp"
#include "veridyn/vehicle/simulation/stepped_vehicle.hpp"

namespace veridyn::cueing {
namespace {

using recording::MotionSample;

/// Level at first, then with its left side up.
struct BankedRoad : vehicle::Road {
  double bank = 0.0;
  [[nodiscard]] double height(const vehicle::RoadPoint& at) const override {
    return std::tan(bank) * std::clamp((at.x - 50.0) / 30.0, 0.0, 1.0) * at.y;
  }
};

/// The family car at 15 m/s, straight on for 3 s, then with this steer; felt at the driver's head.
std::vector<MotionSample> driven(double steer, double bank) {
  const vehicle::Vehicle car = vehicle::read_vehicle(
      Study::parse("[subject]\nkind = \"vehicle\"\nbuiltin = \"reference\"\n", "car.toml").root().table("subject"),
      vehicle::VehicleNeeds::kFourWheel);
  vehicle::FourWheelOptions options = vehicle::four_wheel_options(car);
  options.longitudinal.reset();
  auto road = std::make_shared<BankedRoad>();
  road->bank = bank;
  const auto drive = vehicle::stepped_vehicle(car, options, road);
  drive->reset(15.0);
  std::vector<MotionSample> samples;
  for (int k = 0; k < 2500; ++k) {
    const double since = std::clamp(0.01 * k - 3.0, 0.0, 1.0);
    drive->step({.steer = steer * since}, 0.01);
    samples.push_back(drive->motion({0.2, 0.35, 0.5}));
  }
  return samples;
}

struct Rendered {
  double vehicle_roll, force, acceleration;  ///< at the end, and the largest acceleration to the right (frd)
  double roll, shift;                        ///< of the platform, at the end, and the largest
};

Rendered rendered(const std::vector<MotionSample>& drive, const std::string& algorithm) {
  const Platform& platform = built_in_platform("hexapod");
  Progress silent;
  const CueingRun run = drive_platform(drive, *washout_algorithm(algorithm).design()->make(platform), platform, silent);
  Rendered r{};
  const MotionSample& last = run.vehicle.back();
  const Eigen::Vector3d down = last.attitude.conjugate() * Eigen::Vector3d::UnitZ();
  r.vehicle_roll = std::atan2(down.y(), down.z());
  r.force = last.force.y();
  r.roll = axis(run.steps.back().ordered, PlatformAxis::kRoll).position;
  for (std::size_t k = 0; k < run.steps.size(); ++k) {
    r.acceleration = std::max(r.acceleration, std::abs(recording::acceleration(run.vehicle[k]).y()));
    r.shift = std::max(r.shift, std::abs(axis(run.steps[k].ordered, PlatformAxis::kSway).position));
  }
  return r;
}

TEST(SimulatedDrives, CorneringAndABankedRoadAreToldApart) {
  // A right turn, and straight on over a bank with the left side up: sensors of force show the one to the right, the
  // other to the left.
  const auto cornering = driven(-0.03, 0.0), banked = driven(0.0, 8.0 * kDegree);
  for (const char* algorithm : {"classical", "optimal", "mpc"}) {
    const Rendered corner = rendered(cornering, algorithm), bank = rendered(banked, algorithm);
    // Cornering to the right: force to the right, the body leans to the left.
    EXPECT_GT(corner.force, 1.0) << algorithm;
    EXPECT_LT(corner.vehicle_roll, 0.0);
    // On the bank: right side down, gravity's share to the left, no acceleration.
    // The body leans on its springs beyond the bank.
    EXPECT_GT(bank.vehicle_roll, 8.0 * kDegree);
    EXPECT_LT(bank.vehicle_roll, 10.0 * kDegree);
    EXPECT_NEAR(bank.force, -kGravity * std::sin(bank.vehicle_roll), 0.02);
    EXPECT_LT(bank.acceleration, 0.2 * corner.acceleration);
    // The platform stands as the bank does, right side down, and as the force of the corner asks for, left side down.
    EXPECT_GT(bank.roll, 2.0 * kDegree) << algorithm;
    EXPECT_LT(corner.roll, -2.0 * kDegree) << algorithm;
    // Only the corner's force is one to shift for.
    EXPECT_LT(bank.shift, 0.5 * corner.shift) << algorithm;
  }
}

}  // namespace
}  // namespace veridyn::cueing
