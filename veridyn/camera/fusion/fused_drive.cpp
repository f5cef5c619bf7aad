#include "veridyn/camera/fusion/fused_drive.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/io/tables/table.hpp"

namespace veridyn::camera {

std::vector<InertialReading> parse_inertial(std::string_view text, std::string source) {
  const io::Table table = io::parse_table(text, std::move(source));
  const auto column = [&](const char* name, const char* unit) -> const std::vector<double>& {
    const io::TableColumn& c = table.at(name);
    if (!c.unit.same_dimension(parse_unit(unit)))
      throw InputError(table.source, fmt::format("column '{}' is in {}; must be in {}, as {}[{}]", name, c.unit.name,
                                                 unit, name, unit));
    return c.value;
  };
  const auto& time = column("time", "s");
  const std::array rate{&column("rate_x", "rad/s"), &column("rate_y", "rad/s"), &column("rate_z", "rad/s")};
  const std::array force{&column("force_x", "m/s^2"), &column("force_y", "m/s^2"), &column("force_z", "m/s^2")};
  std::vector<InertialReading> readings;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    InertialReading r{.time = time[i], .rate = {}, .force = {}};
    for (int k = 0; k < 3; ++k) {
      r.rate(k) = (*rate[k])[i];
      r.force(k) = (*force[k])[i];
    }
    const std::string place = fmt::format("{}:{}", table.source, table.lines[i]);
    if (!std::isfinite(r.time) || !r.rate.allFinite() || !r.force.allFinite())
      throw InputError(place, "a cell is missing or not a finite number");
    if (!readings.empty() && !(r.time > readings.back().time))
      throw InputError(place, fmt::format("its time {} s does not follow {} s", r.time, readings.back().time));
    readings.push_back(r);
  }
  return readings;
}

std::vector<InertialReading> read_inertial(const std::filesystem::path& path) {
  return parse_inertial(read_file(path), path.string());
}

FusedDrive fuse(std::span<const InertialReading> inertial, std::span<const TimedPose> poses,
                const FusionOptions& options) {
  InertialCameraFusion fusion(options);
  FusedDrive drive;
  std::size_t next = 0;
  for (const InertialReading& r : inertial) {
    while (next < poses.size() && poses[next].time <= r.time) {
      const TimedPose& p = poses[next++];
      ++(fusion.add_camera(p.time, p.pose, p.covariance) ? drive.frames : drive.left_out);
    }
    fusion.add_inertial(r.time, r.rate, r.force);
    if (const auto now = fusion.now()) drive.motion.push_back(*now);
  }
  drive.left_out += poses.size() - next;
  drive.gaps = fusion.gaps();
  for (std::size_t i = 0; i < drive.innovations.size(); ++i) drive.innovations[i] = fusion.innovations()[i].summary();
  if (drive.motion.empty())
    throw InputError("fusion", "the inertial sensors and the poses of the camera have no time in common");
  return drive;
}

std::string to_csv(std::span<const FusedMotion> motion) {
  constexpr std::array kNames{"x[m]",
                              "y[m]",
                              "velocity_x[m/s]",
                              "velocity_y[m/s]",
                              "heading[rad]",
                              "pitch[rad]",
                              "roll[rad]",
                              "gyro_bias_x[rad/s]",
                              "gyro_bias_y[rad/s]",
                              "gyro_bias_z[rad/s]",
                              "accel_bias_x[m/s^2]",
                              "accel_bias_y[m/s^2]",
                              "accel_bias_z[m/s^2]",
                              "offset[s]",
                              "acceleration_x[m/s^2]",
                              "acceleration_y[m/s^2]"};
  std::string text = "time[s]";
  for (const char* name : kNames) text += fmt::format(",{}", name);
  for (const char* name : kNames) text += fmt::format(",sigma_{}", name);
  text += "\n";
  for (const FusedMotion& m : motion) {
    Eigen::Matrix<double, InertialModel::kStates, 1> state;
    state << m.position, m.velocity, m.heading, m.pitch, m.roll, m.gyro_bias, m.accel_bias, m.offset;
    text += fmt::format("{}", m.time);
    for (const double value : state) text += fmt::format(",{}", value);
    text += fmt::format(",{},{}", m.acceleration(0), m.acceleration(1));
    for (const double value : m.sigma) text += fmt::format(",{}", value);
    text += fmt::format(",{},{}\n", m.sigma_acceleration(0), m.sigma_acceleration(1));
  }
  return text;
}

}  // namespace veridyn::camera
