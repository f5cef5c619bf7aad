#pragma once

#include "veridyn/vehicle/manoeuvre/path.hpp"
#include "veridyn/vehicle/model/vehicle_trajectory.hpp"

namespace veridyn::vehicle::testing {

/// A drive along a path at `speed` [m/s], the body tangent to it, mirrored by `side` -1, then shifted to the left [m].
inline VehicleTrajectory tangent_drive(const Path& path, double speed, double side = 1.0, double shift = 0.0) {
  VehicleTrajectory t;
  for (double s = 0.0; s < path.length(); s += 0.05) {
    const PathPoint p = path.at(s);
    t.time.push_back(s / speed);
    t.x.push_back(p.x);
    t.y.push_back(side * p.y + shift);
    t.yaw.push_back(side * p.heading);
  }
  return t;
}

}  // namespace veridyn::vehicle::testing
