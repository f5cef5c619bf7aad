#pragma once

#include "veridyn/vehicle/manoeuvre/lane_change.hpp"
#include "veridyn/vehicle/manoeuvre/path.hpp"
#include "veridyn/vehicle/model/vehicle_trajectory.hpp"

namespace veridyn::vehicle {

/// Cones in a line along x, passed in turn on their left and right: our own definition, as no standard has one. The
/// first stands at x = 40 m and is passed on its left.
struct Slalom {
  int cones = 8;
  double spacing = 18.0;        ///< between neighbours [m]
  double clearance = 0.5;       ///< of the path: from a cone to the body's flank [m]
  double vehicle_width = 1.75;  ///< [m]
  /// For a driver: from the origin, at every cone parallel to their line and half the width and the clearance aside,
  /// in between lateral shifts of the fifth degree without curvature at both ends.
  Path path;

  [[nodiscard]] double cone(int i) const;                                      ///< x of the i-th, from 0 [m]
  [[nodiscard]] static double side(int i) { return i % 2 == 0 ? 1.0 : -1.0; }  ///< 1: passed on its left
};
/// @throws InputError("slalom", ...) for fewer than one cone, and lengths that are not > 0 (clearance: < 0).
[[nodiscard]] Slalom slalom_course(int cones, double spacing, double clearance, double vehicle_width);

/// How a body passed the cones.
struct ConeCheck {
  int hit = 0;          ///< cones that the body touched, or had on the wrong side
  int passed = 0;       ///< cones that the body has left behind
  double margin = 0.0;  ///< smallest distance of a flank to its cone; negative: hit [m]
  int nearest = 0;      ///< that cone, from 1
};
/// By the body at every sample: each cone while it is between the body's front and rear.
[[nodiscard]] ConeCheck check_cones(const VehicleTrajectory& trajectory, const Slalom& course, const BodyOutline& body);

}  // namespace veridyn::vehicle
