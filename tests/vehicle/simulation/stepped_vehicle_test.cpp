#include "veridyn/vehicle/simulation/stepped_vehicle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <variant>

#include "veridyn/core/study.hpp"
#include "veridyn/vehicle/simulation_study.hpp"

namespace veridyn::vehicle {
namespace {

/// A saloon on tyres of this kind, with wheels that spin.
SimulationStudy saloon_on(const std::string& tyre) {
  const Study study = Study::parse("[subject]\nkind = \"vehicle\"\nbuiltin = \"saloon\"\nmu = 0.9\ntyre = \"" + tyre +
                                       "\"\n[drive]\nmodel = \"four-wheel\"\nlongitudinal = true\n",
                                   "s.toml");
  const Progress silent;
  return read_simulation_study(study.root(), silent);
}

Controls weaving(int k) { return {.steer = 0.05 * std::sin(0.02 * k), .drive_torque = 200.0}; }

TEST(SteppedVehicle, IsTheSteppedDriveOfItsTyres) {
  for (const char* tyre : {"linear", "fiala", "magic formula"}) {
    const SimulationStudy study = saloon_on(tyre);
    const std::unique_ptr<SteppedVehicle> vehicle = stepped_vehicle(study.vehicle, study.four_wheel);
    std::visit(
        [&]<typename Tyre>(const AxleTyres<Tyre>& tyres) {
          SteppedDrive<Tyre> drive(
              FourWheelModel<double, Tyre>(study.vehicle.parameters, mounted(tyres), study.four_wheel));
          vehicle->reset(15.0);
          drive.reset(15.0);
          for (int k = 0; k < 500; ++k) {
            vehicle->step(weaving(k), 0.01);
            drive.step(weaving(k), 0.01);
          }
          EXPECT_EQ(vehicle->state().vehicle, drive.state().vehicle) << tyre;
          EXPECT_TRUE((vehicle->loads() == drive.rates().Fz).all()) << tyre;
          EXPECT_NEAR(vehicle->loads().sum(), study.vehicle.parameters.mass * 9.80665, 500.0) << tyre;
          EXPECT_GT(std::abs(vehicle->state().vehicle(kYaw)), 0.01) << tyre;
        },
        study.vehicle.tyres);
  }
}

TEST(SteppedVehicle, MovesInTheWorldAsItsVelocitySays) {
  const SimulationStudy study = saloon_on("fiala");
  const std::unique_ptr<SteppedVehicle> vehicle = stepped_vehicle(study.vehicle, study.four_wheel);
  vehicle->reset(15.0);
  for (int k = 0; k < 300; ++k) vehicle->step(weaving(k), 0.01);
  // Central differences over 2 ms: an error of a third of the jerk times the square of 1 ms.
  const WorldMotion before = vehicle->world();
  vehicle->step(weaving(300), 0.001);
  const Eigen::Vector3d velocity = vehicle->world().velocity;
  vehicle->step(weaving(300), 0.001);
  const Eigen::Vector3d moved = (vehicle->world().position - before.position) / 0.002;
  EXPECT_NEAR((moved - velocity).norm(), 0.0, 1e-4);
  EXPECT_GT(std::abs(velocity.y()), 0.05) << "it does not drive along x";
}

TEST(SteppedVehicle, HasClonesThatDriveOnByThemselves) {
  const SimulationStudy study = saloon_on("fiala");
  const std::unique_ptr<SteppedVehicle> vehicle = stepped_vehicle(study.vehicle, study.four_wheel);
  vehicle->reset(15.0);
  vehicle->step(weaving(50), 0.5);
  const DriveState saved = vehicle->state();
  const std::unique_ptr<SteppedVehicle> clone = vehicle->clone();
  clone->step(weaving(50), 0.5);
  EXPECT_EQ(vehicle->state().vehicle, saved.vehicle) << "the clone's step moved the original";
  vehicle->step(weaving(50), 0.5);
  EXPECT_EQ(vehicle->state().vehicle, clone->state().vehicle);
  vehicle->reset(saved);
  EXPECT_EQ(vehicle->state().vehicle, saved.vehicle);
  EXPECT_EQ(vehicle->state().time, saved.time);
}

}  // namespace
}  // namespace veridyn::vehicle
