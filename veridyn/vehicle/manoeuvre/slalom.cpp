#include "veridyn/vehicle/manoeuvre/slalom.hpp"

#include <fmt/format.h>

#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"

namespace veridyn::vehicle {
namespace {

/// Straight way before the first cone [m].
constexpr double kStraightWay = 40.0;

}  // namespace

double Slalom::cone(int i) const { return kStraightWay + i * spacing; }

Slalom slalom_course(int cones, double spacing, double clearance, double vehicle_width) {
  const auto require = [](bool good, const char* name, double value, const char* rule) {
    if (!good) throw InputError("slalom", fmt::format("{} is {:g}; must be {}", name, value, rule));
  };
  require(cones >= 1 && cones <= 1000, "cones", cones, "1 to 1000");
  require(spacing > 0.0 && spacing < kInfinity, "spacing", spacing, "> 0 m");
  require(clearance >= 0.0 && clearance < kInfinity, "clearance", clearance, ">= 0 m");
  require(vehicle_width > 0.0 && vehicle_width < kInfinity, "vehicle_width", vehicle_width, "> 0 m");
  require(spacing < 2.0 * kStraightWay, "spacing", spacing, "less than 80 m");
  Slalom course;
  course.cones = cones;
  course.spacing = spacing;
  course.clearance = clearance;
  course.vehicle_width = vehicle_width;
  const double aside = 0.5 * vehicle_width + clearance;
  // Half a spacing each from the line to the first cone and from the last cone back.
  course.path.append_line(kStraightWay - 0.5 * spacing).append_lane_change(0.5 * spacing, aside);
  for (int i = 1; i < cones; ++i) course.path.append_lane_change(spacing, 2.0 * aside * Slalom::side(i));
  course.path.append_lane_change(0.5 * spacing, -aside * Slalom::side(cones - 1)).append_line(kStraightWay);
  return course;
}

ConeCheck check_cones(const VehicleTrajectory& t, const Slalom& course, const BodyOutline& body) {
  ConeCheck check;
  check.margin = kInfinity;
  for (int i = 0; i < course.cones; ++i) {
    double margin = kInfinity;
    bool seen = false, behind = false;
    for (std::size_t k = 0; k < t.size(); ++k) {
      const double c = std::cos(t.yaw[k]), s = std::sin(t.yaw[k]);
      const double dx = course.cone(i) - t.x[k], dy = -t.y[k];
      const double ahead = c * dx + s * dy, left = c * dy - s * dx;  // where the body sees the cone
      if (ahead <= body.ahead && ahead >= -body.behind) {
        seen = true;
        margin = std::min(margin, -Slalom::side(i) * left - 0.5 * body.width);
      }
      behind = behind || (seen && ahead < -body.behind);
    }
    if (!seen) continue;
    check.passed += behind ? 1 : 0;
    check.hit += margin < 0.0 ? 1 : 0;
    if (margin < check.margin) {
      check.margin = margin;
      check.nearest = i + 1;
    }
  }
  return check;
}

}  // namespace veridyn::vehicle
