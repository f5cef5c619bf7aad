#include "veridyn/vehicle/manoeuvre/lane_change.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::vehicle {
namespace {

/// Straight way before the first lane [m].
constexpr double kApproach = 40.0;

struct Corner {
  double x, y;
};

std::array<Corner, 4> corners_of(const VehicleTrajectory& t, std::size_t k, const BodyOutline& body) {
  const double c = std::cos(t.yaw[k]), s = std::sin(t.yaw[k]);
  const auto place = [&](double ahead, double left) {
    return Corner{t.x[k] + c * ahead - s * left, t.y[k] + s * ahead + c * left};
  };
  const double half = 0.5 * body.width;
  return {place(body.ahead, half), place(body.ahead, -half), place(-body.behind, -half), place(-body.behind, half)};
}

DoubleLaneChange empty_course(double vehicle_width, double scale) {
  if (!(scale > 0.0 && std::isfinite(scale)))
    throw InputError("double lane change", fmt::format("scale is {:g}; must be > 0", scale));
  if (!(vehicle_width > 0.0 && std::isfinite(vehicle_width))) {
    throw InputError("double lane change", fmt::format("vehicle width is {:g} m; must be > 0", vehicle_width));
  }
  DoubleLaneChange course;
  course.vehicle_width = vehicle_width;
  course.scale = scale;
  return course;
}

}  // namespace

DoubleLaneChange iso_double_lane_change(double vehicle_width, double scale) {
  DoubleLaneChange course = empty_course(vehicle_width, scale);
  const double w = vehicle_width / scale;
  const std::array<double, 3> width{1.1 * w + 0.25, 1.2 * w + 0.25, 1.3 * w + 0.25};
  const double right = -0.5 * width[0];
  const double first = kApproach;
  course.lanes = {{{first, first + 15.0, right, right + width[0]},
                   {first + 45.0, first + 70.0, right + 3.5, right + 3.5 + width[1]},
                   {first + 95.0, first + 125.0, right, right + width[2]}}};
  for (Lane& lane : course.lanes) lane = {scale * lane.begin, scale * lane.end, scale * lane.right, scale * lane.left};
  const auto middle = [&](std::size_t i) { return 0.5 * (course.lanes[i].right + course.lanes[i].left); };
  // Shifts begin and end a little within the lanes, where the lane is wide enough for the vehicle: a gentler curve. A
  // driver who looks ahead rounds it further.
  const double early = 2.0 * scale;
  course.path.append_line((kApproach + 15.0) * scale - early)
      .append_lane_change(30.0 * scale + 2.0 * early, middle(1))
      .append_line(25.0 * scale - 2.0 * early)
      .append_lane_change(25.0 * scale + 2.0 * early, middle(2) - middle(1))
      .append_line(30.0 * scale - early + 60.0 * scale);
  return course;
}

DoubleLaneChange iso_obstacle_avoidance(double vehicle_width, double scale) {
  DoubleLaneChange course = empty_course(vehicle_width, scale);
  course.standard = "ISO 3888-2";
  const double w = vehicle_width / scale;
  const std::array<double, 3> width{1.1 * w + 0.25, w + 1.0, std::min(1.3 * w + 0.25, 3.0)};
  const double right = -0.5 * width[0], second = right + width[0] + 1.0;
  const double first = kApproach;
  course.lanes = {{{first, first + 12.0, right, right + width[0]},
                   {first + 25.5, first + 36.5, second, second + width[1]},
                   {first + 49.0, first + 61.0, right, right + width[2]}}};
  for (Lane& lane : course.lanes) lane = {scale * lane.begin, scale * lane.end, scale * lane.right, scale * lane.left};
  // In the second lane half a metre is left on both sides of the body, of which the path leaves less on the right; the
  // longer and smaller shifts are gentler.
  const double aside = scale * (second + 0.5 * w + 0.3), back = 0.5 * (course.lanes[2].right + course.lanes[2].left);
  const double early = 3.0 * scale;
  course.path.append_line((kApproach + 12.0) * scale - early)
      .append_lane_change(13.5 * scale + 2.0 * early, aside)
      .append_line(11.0 * scale - 2.0 * early)
      .append_lane_change(12.5 * scale + 2.0 * early, back - aside)
      .append_line(12.0 * scale - early + 60.0 * scale);
  return course;
}

LaneCheck check_lanes(const VehicleTrajectory& trajectory, const DoubleLaneChange& course, const BodyOutline& body) {
  LaneCheck check;
  check.margin = kInfinity;
  for (std::size_t k = 0; k < trajectory.size(); ++k) {
    const std::array<Corner, 4> corners = corners_of(trajectory, k, body);
    for (std::size_t i = 0; i < course.lanes.size(); ++i) {
      const Lane& lane = course.lanes[i];
      const auto see = [&](double y) {
        const double margin = std::min(y - lane.right, lane.left - y);
        if (!(margin < check.margin)) return;
        check.margin = margin;
        check.time = trajectory.time[k];
        check.lane = static_cast<int>(i) + 1;
      };
      // The part of the body within the lane is a polygon of corners and of edges cut by the lane's ends.
      for (std::size_t j = 0; j < corners.size(); ++j) {
        const Corner& p = corners[j];
        const Corner& q = corners[(j + 1) % corners.size()];
        if (p.x >= lane.begin && p.x <= lane.end) see(p.y);
        for (const double cut : {lane.begin, lane.end}) {
          if ((p.x - cut) * (q.x - cut) < 0.0) see(p.y + (q.y - p.y) * (cut - p.x) / (q.x - p.x));
        }
      }
    }
    if (k + 1 == trajectory.size()) {
      const double last = std::ranges::min(corners, {}, &Corner::x).x;
      check.finished = last > course.lanes.back().end;
    }
  }
  check.within = check.margin >= 0.0 && trajectory.size() > 0;
  return check;
}

}  // namespace veridyn::vehicle
