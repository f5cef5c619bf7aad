#include "veridyn/vehicle/simulation/drive_sensors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/random.hpp"

namespace veridyn::vehicle {
namespace {

/// A series of the trajectory at any time within it, on the straight line between samples.
double at(const std::vector<double>& time, const std::vector<double>& value, double t) {
  const auto next = std::upper_bound(time.begin(), time.end(), t);
  if (next == time.begin()) return value.front();
  if (next == time.end()) return value.back();
  const auto i = static_cast<std::size_t>(next - time.begin());
  const double share = (t - time[i - 1]) / (time[i] - time[i - 1]);
  return (1.0 - share) * value[i - 1] + share * value[i];
}

}  // namespace

DriveSensorSet reference_drive_sensors() {
  DriveSensorSet set;
  set[DriveSensorKind::kSteer] = {.sigma = 0.1 * kDegree, .bias_sigma = 0.1 * kDegree};
  set[DriveSensorKind::kSpeed] = {.sigma = 0.05};
  set[DriveSensorKind::kYawRate] = {.sigma = 0.1 * kDegree, .bias_sigma = 0.2 * kDegree};
  set[DriveSensorKind::kAccelY] = {.sigma = 0.05, .bias_sigma = 0.1};
  set[DriveSensorKind::kAccelX] = {.sigma = 0.05, .bias_sigma = 0.1};
  set[DriveSensorKind::kLateralVelocity] = {.enabled = false, .sigma = 0.02};
  set[DriveSensorKind::kPosition] = {.enabled = false, .rate_Hz = 10.0, .sigma = 0.05};
  return set;
}

DriveSensorSet read_drive_sensors(const StudyTable& table) {
  const std::vector<std::string> sets{"reference", "perfect"};
  DriveSensorSet set = reference_drive_sensors();
  if (table.choice_or("set", sets, "reference") == "perfect") {
    for (DriveSensor& sensor : set.sensors) sensor = {.enabled = sensor.enabled, .rate_Hz = sensor.rate_Hz};
  }
  if (table.has("accel_position")) {
    const std::vector<double> p = table.numbers("accel_position", "m");
    if (p.size() != 3) table.fail("accel_position", fmt::format("has {} numbers; must have 3: x, y, z", p.size()));
    std::copy(p.begin(), p.end(), set.accel_position.begin());
  }
  set.feels_gravity = table.flag_or("feels_gravity", set.feels_gravity);
  for (const DriveSensorKind kind : enumerators<DriveSensorKind, kDriveSensors>()) {
    if (!table.has(kDriveSensorNames[kind])) continue;
    const StudyTable t = table.table(kDriveSensorNames[kind]);
    const std::string_view unit = kDriveSensorUnits[kind];
    DriveSensor& s = set[kind];
    s.enabled = t.flag_or("enabled", true);
    s.rate_Hz = t.positive_or("rate", "Hz", s.rate_Hz);
    s.sigma = t.number_or("sigma", unit, s.sigma);
    s.bias = t.number_or("bias", unit, s.bias);
    s.bias_sigma = t.number_or("bias_sigma", unit, s.bias_sigma);
    s.scale = t.number_or("scale", "1", s.scale);
    s.delay_s = t.number_or("delay", "s", s.delay_s);
    if (!(s.sigma >= 0.0)) t.fail("sigma", fmt::format("= {:g} must be >= 0", s.sigma));
    if (!(s.bias_sigma >= 0.0)) t.fail("bias_sigma", fmt::format("= {:g} must be >= 0", s.bias_sigma));
    if (!(s.scale > -1.0)) t.fail("scale", fmt::format("= {:g} must be > -1", s.scale));
  }
  return set;
}

Recording record_drive(const VehicleTrajectory& trajectory, const DriveSensorSet& sensors, std::uint64_t seed) {
  Recording out;
  out.source = "simulated drive";
  out.frame = Frame::kFlu;
  const std::vector<double>& time = trajectory.time;
  if (time.size() < 2) return out;
  const std::size_t n = time.size();
  const auto angle = [](const std::vector<double>& v, std::size_t k) { return v.empty() ? 0.0 : v[k]; };

  const auto [px, py, pz] = sensors.accel_position;
  std::vector<double> accel_x(n), accel_y(n);
  for (std::size_t k = 0; k < n; ++k) {
    const double r = trajectory.r[k], dr = trajectory.yaw_acceleration[k];
    const double roll = angle(trajectory.roll, k), pitch = angle(trajectory.pitch, k);
    // Rotation about z of the plane motion; what roll acceleration adds at a height is left out.
    accel_x[k] = trajectory.longitudinal_acceleration[k] - dr * py - r * r * px;
    accel_y[k] = trajectory.lateral_acceleration[k] + dr * px - r * r * py;
    if (!sensors.feels_gravity) continue;
    accel_y[k] = accel_y[k] * std::cos(roll) + sensors.gravity * std::sin(roll);
    accel_x[k] = accel_x[k] * std::cos(pitch) - sensors.gravity * std::sin(pitch);
  }
  static_cast<void>(pz);

  struct Source {
    DriveSensorKind kind;
    const char* channel;
    const std::vector<double>* value;
  };
  const std::array<Source, 8> sources{{{DriveSensorKind::kSteer, "steer", &trajectory.steer},
                                       {DriveSensorKind::kSpeed, "speed", &trajectory.u},
                                       {DriveSensorKind::kYawRate, "yaw_rate", &trajectory.r},
                                       {DriveSensorKind::kAccelY, "accel_y", &accel_y},
                                       {DriveSensorKind::kAccelX, "accel_x", &accel_x},
                                       {DriveSensorKind::kLateralVelocity, "lateral_velocity", &trajectory.v},
                                       {DriveSensorKind::kPosition, "pos_x", &trajectory.x},
                                       {DriveSensorKind::kPosition, "pos_y", &trajectory.y}}};
  for (const Source& source : sources) {
    const DriveSensor& sensor = sensors[source.kind];
    if (!sensor.enabled || source.value->size() != n) continue;
    numerics::RandomStream noise(seed, source.channel);
    const double bias = sensor.bias + sensor.bias_sigma * noise.normal();
    std::vector<double> stamps, values;
    const double step = 1.0 / sensor.rate_Hz;
    for (long long i = 0;; ++i) {
      const double t = time.front() + static_cast<double>(i) * step;
      if (t > time.back() + 1e-9) break;
      stamps.push_back(t + sensor.delay_s);
      values.push_back(bias + (1.0 + sensor.scale) * at(time, *source.value, t) + sensor.sigma * noise.normal());
    }
    out.add(make_channel(source.channel, kDriveSensorUnits[source.kind], make_time_base(std::move(stamps)),
                         std::move(values)));
  }
  return out;
}

}  // namespace veridyn::vehicle
