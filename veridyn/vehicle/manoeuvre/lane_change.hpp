#pragma once

#include <array>
#include <optional>
#include <string>

#include "veridyn/vehicle/manoeuvre/path.hpp"
#include "veridyn/vehicle/model/vehicle_trajectory.hpp"

namespace veridyn::vehicle {

/// A lane between cones: y within (right, left) for x within [begin, end] [m].
struct Lane {
  double begin = 0.0, end = 0.0;
  double right = 0.0, left = 0.0;
};

/// A course of three lanes between cones, entered along x.
///
/// The severe double lane change of ISO 3888-1: three lanes of 15, 25 and 30 m with 30 and 25 m between them, the
/// second 3.5 m to the left of the first (right edge to right edge). Widths follow the vehicle's width w: 1.1 w + 0.25
/// m, 1.2 w
/// + 0.25 m, 1.3 w + 0.25 m. The first lane begins at x = 40 m (times `scale`), its
/// middle is y = 0: a vehicle that starts at the origin has 40 m to settle.
struct DoubleLaneChange {
  double vehicle_width = 1.75;  ///< w, without mirrors [m]
  double scale = 1.0;           ///< all lengths of the course, for a scaled car; vehicle_width is the real one
  std::string standard = "ISO 3888-1";
  std::array<Lane, 3> lanes{};
  Path path;  ///< for a driver: from the origin through the middles of the lanes
};
/// @throws InputError when width or scale is not > 0.
[[nodiscard]] DoubleLaneChange iso_double_lane_change(double vehicle_width, double scale = 1.0);

/// The obstacle avoidance of ISO 3888-2 (61 m): lanes of 12, 11 and 12 m with 13.5 and 12.5 m between them, 1.1 w +
/// 0.25 m, w + 1 m and the smaller of 1.3 w + 0.25 m and 3 m wide. The second lane's right edge is 1 m to the left of
/// the first lane's left edge; the third lane's right edge is in line with the first one's. Begins at x = 40 m as the
/// other. Sources at hand agree on all but the last lane, which some have at 3 m for every vehicle: ours is the
/// narrower one. The path for a driver is our own: it keeps to the right in the second lane, and turns within lanes
/// where they leave room for it.
/// @throws InputError when width or scale is not > 0.
[[nodiscard]] DoubleLaneChange iso_obstacle_avoidance(double vehicle_width, double scale = 1.0);

/// The body of a vehicle as cones see it: a rectangle about the centre of gravity [m].
struct BodyOutline {
  double ahead = 1.25;  ///< of the centre of gravity: a and the overhang
  double behind = 1.0;
  double width = 1.75;
};

/// Where a body came nearest to the edge of its lane.
struct LaneCheck {
  bool within = true;     ///< no corner left its lane
  bool finished = false;  ///< the whole body left the last lane at its end
  double margin = 0.0;    ///< smallest distance of a corner to the edge of its lane; negative outside [m]
  double time = 0.0;      ///< of it [s]
  int lane = 0;           ///< 1, 2, 3
};
/// By the corners of the body at every sample of the trajectory.
[[nodiscard]] LaneCheck check_lanes(const VehicleTrajectory& trajectory, const DoubleLaneChange& course,
                                    const BodyOutline& body);

}  // namespace veridyn::vehicle
