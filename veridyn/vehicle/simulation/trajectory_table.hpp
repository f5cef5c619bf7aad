#pragma once

#include <span>

#include "veridyn/core/recording.hpp"
#include "veridyn/vehicle/model/vehicle_trajectory.hpp"

namespace veridyn::vehicle {

/// A quantity of a trajectory as recordings name it.
struct TrajectoryQuantity {
  const char* name;
  const char* unit;  ///< SI
  const char* meaning;
  std::vector<double> VehicleTrajectory::*values;
};

/// The same of each wheel; recordings append _fl, _fr, _rl, _rr.
struct WheelQuantity {
  const char* name;
  const char* unit;
  const char* meaning;
  PerWheel<std::vector<double>> VehicleTrajectory::*values;
};

/// All quantities but time.
[[nodiscard]] std::span<const TrajectoryQuantity> trajectory_quantities();
/// The quantities that each wheel has.
[[nodiscard]] std::span<const WheelQuantity> wheel_quantities();

/// A trajectory as a recording in frame flu: what the model has, each a channel of the common time base; `speed` is u.
[[nodiscard]] Recording to_recording(const VehicleTrajectory& trajectory);

}  // namespace veridyn::vehicle
