#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/report/document/document.hpp"
#include "veridyn/vehicle/manoeuvre/manoeuvre.hpp"
#include "veridyn/vehicle/model/vehicle_trajectory.hpp"

namespace veridyn::report {

/// View of a drive to be drawn, under its name; drives in one picture overlay.
struct ShownDrive {
  std::string name;
  const vehicle::VehicleTrajectory* trajectory = nullptr;
  Role role = Role::kEstimate;
};

/// The path on the plane, seen from above.
[[nodiscard]] XYPlot path_figure(std::span<const ShownDrive> drives);

/// The cones between which, or around which, a manoeuvre leads, in the plane of `path_figure`: the edges of lanes as
/// lines, the cones of a slalom as points. Empty: it has none.
[[nodiscard]] std::vector<XYSeries> course_series(const vehicle::Manoeuvre& manoeuvre);

/// Lateral against longitudinal acceleration, in g. @param gravity [m/s^2] of the drives
[[nodiscard]] XYPlot g_g_figure(std::span<const ShownDrive> drives, double gravity);

/// Steering, yaw, yaw rate and acceleration, lateral acceleration and velocity, speed where it changes.
[[nodiscard]] TimeSeries motion_figure(std::span<const ShownDrive> drives);

/// Slip angles and lateral forces of the four tyres; longitudinal ones where there are any.
[[nodiscard]] TimeSeries tyre_figure(std::span<const ShownDrive> drives);

/// Roll, pitch, heave, normal forces and wheel travel; empty (no panel) for a model without vertical motion.
/// @param static_loads [N], one a drive: normal forces are drawn as differences from them; empty: as they are
[[nodiscard]] TimeSeries ride_figure(std::span<const ShownDrive> drives,
                                     std::span<const vehicle::PerWheel<double>> static_loads = {});

}  // namespace veridyn::report
