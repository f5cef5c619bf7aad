// Counts calls of operator new, hence in a separate file: a longer drive with the same samples must not call it more.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "tests/support/counting_new.hpp"
#include "tests/vehicle/model/moments.hpp"
#include "veridyn/vehicle/simulation/stepped_drive.hpp"
#include "veridyn/vehicle/simulation/vehicle_simulation.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"

namespace veridyn::vehicle {
namespace {

struct Slalom : Driver {
  [[nodiscard]] Controls controls(double time) const override {
    return {.steer = 0.04 * std::sin(2.0 * time), .drive_torque = 300.0};
  }
};
struct Waves : Road {
  [[nodiscard]] double height(const RoadPoint& point) const override { return 0.01 * std::sin(point.distance); }
};

TEST(VehicleSimulation, DoesNotAllocateInItsLoop) {
  const VehicleParameters<double> p;
  const LinearTyre<double> tyre{.stiffness = p.C_f};
  FourWheelOptions longitudinal;
  longitudinal.longitudinal.emplace();
  const FourWheelModel<double, LinearTyre<double>> constant_speed(p, {tyre, tyre, tyre, tyre});
  const FourWheelModel<double, LinearTyre<double>> driven(p, {tyre, tyre, tyre, tyre}, longitudinal);
  const LinearTyre<double> trailing{.stiffness = p.C_f, .pneumatic_trail = 0.03};
  const FourWheelModel<double, LinearTyre<double>> guided(p, {trailing, trailing, trailing, trailing},
                                                          testing::every_option());
  const BicycleModel<double, LinearTyre<double>> bicycle{p, tyre, tyre};
  Slalom driver;
  const Waves road;
  Progress silent;
  const auto allocated = [&](const auto& run, double duration) {
    const SimulationOptions options{.duration = duration, .output_step = duration / 10.0};
    const long before = allocations;
    const VehicleTrajectory out = run(options);
    EXPECT_EQ(out.end, DriveEnd::kCompleted) << out.message();
    return allocations - before;
  };
  const auto check = [&](const auto& run) { EXPECT_EQ(allocated(run, 1.0), allocated(run, 4.0)); };
  check([&](const SimulationOptions& o) { return simulate(constant_speed, driver, &road, o, silent); });
  check([&](const SimulationOptions& o) { return simulate(driven, driver, &road, o, silent); });
  check([&](const SimulationOptions& o) { return simulate(guided, driver, &road, o, silent); });
  check([&](const SimulationOptions& o) { return simulate(bicycle, driver, o, silent); });
}

TEST(SteppedDrive, DoesNotAllocate) {
  const VehicleParameters<double> p;
  const LinearTyre<double> tyre{.stiffness = p.C_f};
  FourWheelOptions longitudinal;
  longitudinal.longitudinal.emplace();
  SteppedDrive<LinearTyre<double>> drive({p, {tyre, tyre, tyre, tyre}, longitudinal}, std::make_shared<const Waves>());
  const long before = allocations;
  for (int k = 0; k < 5000; ++k) {
    drive.step({.steer = 1e-5 * k, .drive_torque = k < 4000 ? 800.0 : 0.0, .brake_torque = k < 4000 ? 0.0 : 3000.0},
               1e-3);
    static_cast<void>(drive.motion({0.0, 0.4, 0.7}));
  }
  const long after = allocations;
  EXPECT_EQ(after, before);
  EXPECT_GT(drive.state().vehicle(kX), 1.0);
}

}  // namespace
}  // namespace veridyn::vehicle
