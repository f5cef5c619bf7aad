#pragma once

#include <functional>

#include "tests/vehicle/cars.hpp"
#include "veridyn/vehicle/model/driver.hpp"
#include "veridyn/vehicle/road/road.hpp"
#include "veridyn/vehicle/simulation/vehicle_simulation.hpp"

namespace veridyn::vehicle::testing {

/// Steers and drives by a function of time.
struct SignalDriver : Driver {
  std::function<Controls(double)> signal;
  explicit SignalDriver(std::function<Controls(double)> s) : signal(std::move(s)) {}
  [[nodiscard]] Controls controls(double time) const override { return signal(time); }
};

/// A road by a function of the place.
struct SignalRoad : Road {
  std::function<double(const RoadPoint&)> signal;
  explicit SignalRoad(std::function<double(const RoadPoint&)> s) : signal(std::move(s)) {}
  [[nodiscard]] double height(const RoadPoint& point) const override { return signal(point); }
};

[[nodiscard]] Controls hands_off(double time);
/// Steer 0 until 2 s, ramp to 5 deg at 3 s, held to 15 s, ramp to 0 at 16 s.
[[nodiscard]] Controls reference_steer(double time);
/// A violent but smooth drive, and a smooth bumpy road on which it keeps all wheels on the ground.
[[nodiscard]] Controls slalom(double time);
[[nodiscard]] double bumps(const RoadPoint& at);

/// `road_car` with anti-roll bars.
[[nodiscard]] VehicleParameters<double> car_with_bars();

[[nodiscard]] VehicleTrajectory drive(const LinearCar<double>& car, const std::function<Controls(double)>& controls,
                                      const SimulationOptions& options, const Road* road = nullptr);

}  // namespace veridyn::vehicle::testing
