#include "tests/vehicle/simulation/drives.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"

namespace veridyn::vehicle::testing {

Controls hands_off(double /*time*/) { return {}; }

Controls reference_steer(double t) {
  return {.steer = 5.0 * kDegree * std::min(std::clamp(t - 2.0, 0.0, 1.0), std::clamp(16.0 - t, 0.0, 1.0))};
}

Controls slalom(double t) { return {.steer = 0.05 * std::sin(4.0 * t)}; }

double bumps(const RoadPoint& at) { return 0.015 * std::sin(0.7 * at.x) * std::cos(0.5 * at.y); }

VehicleParameters<double> car_with_bars() {
  VehicleParameters<double> p = road_car();
  p.K_bf = 9000.0;
  p.K_br = 4000.0;
  return p;
}

VehicleTrajectory drive(const LinearCar<double>& car, const std::function<Controls(double)>& controls,
                        const SimulationOptions& options, const Road* road) {
  SignalDriver driver(controls);
  Progress silent;
  return simulate(car, driver, road, options, silent);
}

}  // namespace veridyn::vehicle::testing
