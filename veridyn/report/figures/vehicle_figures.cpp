#include "veridyn/report/figures/vehicle_figures.hpp"

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/report/figures/curves.hpp"

namespace veridyn::report {
namespace {

using vehicle::kWheelNames;
using vehicle::kWheels;
using vehicle::PerWheel;
using vehicle::VehicleTrajectory;

std::vector<double> shifted(std::vector<double> values, double less) {
  for (double& value : values) value -= less;
  return values;
}

/// All zero: a quantity that this drive does not have, such as longitudinal forces at constant speed.
bool idle(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::abs(v) < 1e-12; });
}

/// View of several drives, whose lines it puts into panels over the first one's time.
class Panels {
 public:
  explicit Panels(std::span<const ShownDrive> drives) : drives_(drives) {}

  /// One line a drive. @param factor to the panel's unit
  void add(const std::string& label, const std::string& unit, std::vector<double> VehicleTrajectory::*quantity,
           double factor) {
    Panel panel{.label = label, .unit = unit};
    for (const ShownDrive& drive : drives_) {
      const std::vector<double>& values = drive.trajectory->*quantity;
      if (!values.empty()) panel.lines.push_back(line(drive, drive.name, scaled(values, factor)));
    }
    keep(std::move(panel));
  }

  /// Four lines a drive, two where left and right are alike.
  void add(const std::string& label, const std::string& unit,
           PerWheel<std::vector<double>> VehicleTrajectory::*quantity, double factor,
           std::span<const PerWheel<double>> less = {}) {
    Panel panel{.label = label, .unit = unit, .height = 190};
    for (std::size_t d = 0; d < drives_.size(); ++d) {
      const ShownDrive& drive = drives_[d];
      const auto& values = drive.trajectory->*quantity;
      const bool alike = values[0] == values[1] && values[2] == values[3];
      for (std::size_t w = 0; w < kWheels; ++w) {
        if (values[w].empty() || idle(values[w]) || (alike && w % 2 == 1)) continue;
        const std::string wheel = alike ? (w == 0 ? "front" : "rear") : std::string(kWheelNames[w]);
        const std::string name = drives_.size() > 1 ? drive.name + " " + wheel : wheel;
        panel.lines.push_back(line(drive, name, scaled(shifted(values[w], less.empty() ? 0.0 : less[d][w]), factor)));
      }
    }
    keep(std::move(panel));
  }

  [[nodiscard]] TimeSeries figure(std::string title, std::string caption) && {
    return {.title = std::move(title),
            .caption = std::move(caption),
            .samples = drives_.front().trajectory->time,
            .panels = std::move(panels_)};
  }

 private:
  [[nodiscard]] Line line(const ShownDrive& drive, std::string name, std::vector<double> y) const {
    const bool separate_time = &drive != &drives_.front() && drive.trajectory->time != drives_.front().trajectory->time;
    return {.name = std::move(name),
            .y = std::move(y),
            .x = separate_time ? drive.trajectory->time : std::vector<double>(),
            .role = drive.role};
  }

  void keep(Panel panel) {
    if (!panel.lines.empty()) panels_.push_back(std::move(panel));
  }

  std::span<const ShownDrive> drives_;
  std::vector<Panel> panels_;
};

bool speed_changes(const ShownDrive& drive) {
  const auto& u = drive.trajectory->u;
  if (u.empty()) return false;
  const auto [low, high] = std::minmax_element(u.begin(), u.end());
  return *high - *low > 1e-6 * std::abs(*high);
}

}  // namespace

XYPlot path_figure(std::span<const ShownDrive> drives) {
  XYPlot plot{.title = "Path", .x = {"x", "m"}, .y = {"y", "m"}, .equal_scale = true, .height = 380};
  for (const ShownDrive& drive : drives) {
    plot.series.push_back({.name = drive.name,
                           .x = drive.trajectory->x,
                           .y = drive.trajectory->y,
                           .role = drive.role,
                           .style = Style::kLine,
                           .width = 2.0});
  }
  return plot;
}

std::vector<XYSeries> course_series(const vehicle::Manoeuvre& manoeuvre) {
  std::vector<XYSeries> series;
  if (manoeuvre.course) {
    for (const vehicle::Lane& lane : manoeuvre.course->lanes) {
      for (const double y : {lane.left, lane.right}) {
        series.push_back({.name = "cones",
                          .x = {lane.begin, lane.end},
                          .y = {y, y},
                          .role = Role::kReference,
                          .style = Style::kLine});
      }
    }
  }
  if (manoeuvre.slalom) {
    XYSeries cones{.name = "cones", .role = Role::kReference, .width = 5.0};
    for (int i = 0; i < manoeuvre.slalom->cones; ++i) {
      cones.x.push_back(manoeuvre.slalom->cone(i));
      cones.y.push_back(0.0);
    }
    series.push_back(std::move(cones));
  }
  return series;
}

XYPlot g_g_figure(std::span<const ShownDrive> drives, double gravity) {
  XYPlot plot{.title = "g-g diagram",
              .x = {"lateral acceleration", "g"},
              .y = {"longitudinal acceleration", "g"},
              .equal_scale = true,
              .height = 380};
  for (const ShownDrive& drive : drives) {
    if (drive.trajectory->longitudinal_acceleration.empty()) continue;
    plot.series.push_back({.name = drive.name,
                           .x = scaled(drive.trajectory->lateral_acceleration, 1.0 / gravity),
                           .y = scaled(drive.trajectory->longitudinal_acceleration, 1.0 / gravity),
                           .role = drive.role,
                           .style = Style::kLine});
  }
  return plot;
}

TimeSeries motion_figure(std::span<const ShownDrive> drives) {
  using T = VehicleTrajectory;
  Panels panels(drives);
  panels.add("steer angle", "deg", &T::steer, 1.0 / kDegree);
  if (std::any_of(drives.begin(), drives.end(), speed_changes)) panels.add("speed", "m/s", &T::u, 1.0);
  panels.add("yaw", "deg", &T::yaw, 1.0 / kDegree);
  panels.add("yaw rate", "deg/s", &T::r, 1.0 / kDegree);
  panels.add("yaw acceleration", "deg/s^2", &T::yaw_acceleration, 1.0 / kDegree);
  panels.add("lateral acceleration", "m/s^2", &T::lateral_acceleration, 1.0);
  panels.add("lateral velocity", "m/s", &T::v, 1.0);
  return std::move(panels).figure("Motion",
                                  "Left is positive (ISO 8855). Accelerations are horizontal, at the centre of "
                                  "gravity.");
}

TimeSeries tyre_figure(std::span<const ShownDrive> drives) {
  using T = VehicleTrajectory;
  Panels panels(drives);
  panels.add("slip angle", "deg", &T::slip_angle, 1.0 / kDegree);
  panels.add("lateral force", "N", &T::Fy, 1.0);
  panels.add("slip ratio", "%", &T::slip_ratio, 100.0);
  panels.add("longitudinal force", "N", &T::Fx, 1.0);
  return std::move(panels).figure("Tyres",
                                  "One line a wheel: front left (fl), front right, rear left, rear right; or one "
                                  "an axle where left and right are alike.");
}

TimeSeries ride_figure(std::span<const ShownDrive> drives, std::span<const PerWheel<double>> static_loads) {
  using T = VehicleTrajectory;
  // A bicycle's trajectory has normal forces too, those at rest.
  if (std::none_of(drives.begin(), drives.end(), [](const ShownDrive& d) { return !d.trajectory->heave.empty(); }))
    return {};
  Panels panels(drives);
  panels.add("roll", "deg", &T::roll, 1.0 / kDegree);
  panels.add("pitch", "deg", &T::pitch, 1.0 / kDegree);
  panels.add("heave", "mm", &T::heave, 1e3);
  panels.add(static_loads.empty() ? "normal force" : "normal force less static load", "N", &T::Fz, 1.0, static_loads);
  panels.add("wheel travel", "mm", &T::wheel_height, 1e3);
  panels.add("suspension travel", "mm", &T::suspension_travel, 1e3);
  panels.add("road", "mm", &T::road, 1e3);
  return std::move(panels).figure(
      "Body and wheels",
      "Roll is positive with the left side up, pitch with the nose down; travel is measured "
      "from the rest position, upwards.");
}

}  // namespace veridyn::report
