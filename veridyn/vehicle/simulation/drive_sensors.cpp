#include "veridyn/vehicle/simulation/drive_sensors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/study_keys.hpp"
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

namespace {

/// `[sensors.NAME]`, in the unit of that sensor.
KeyTable<DriveSensor> keys_of_sensor(std::string_view unit, const std::string& table = "sensors.NAME") {
  using S = DriveSensor;
  const std::string u(unit);
  return KeyTable<S>(table,
                     "A sensor that differs from the set: `steer`, `speed`, `yaw_rate`, `accel_y`, `accel_x`, "
                     "`lateral_velocity` or `position`.")
      .flag("enabled", &S::enabled, "a table switches its sensor on")
      .number("rate", &S::rate_Hz, "Hz", kPositive, "of its samples")
      .otherwise("that of the set")
      .number("sigma", &S::sigma, u, kNotNegative, "standard deviation of the white noise, in the sensor's unit")
      .otherwise("that of the set")
      .number("bias", &S::bias, u, kAnyNumber, "fixed")
      .number("bias_sigma", &S::bias_sigma, u, kNotNegative, "standard deviation of a further bias, drawn once a drive")
      .otherwise("that of the set")
      .number("scale", &S::scale, "1", {.low = -1.0, .with_low = false}, "error of scale")
      .number("delay", &S::delay_s, "s", kAnyNumber, "from event to time stamp");
}

const KeyTable<DriveSensorSet>& keys_of_set() {
  using S = DriveSensorSet;
  static const auto table =
      KeyTable<S>("sensors", "What records a simulated drive.")
          .other({"set", "", "`\"reference\"`, `\"perfect\"`", "\"reference\"",
                  "sensors of production cars, or the same without errors"},
                 [](const StudyTable& t, const std::string& key, S& set) {
                   if (t.choice_or(key, std::vector<std::string>{"reference", "perfect"}, "") == "reference") return;
                   for (DriveSensor& sensor : set.sensors)
                     sensor = {.enabled = sensor.enabled, .rate_Hz = sensor.rate_Hz};
                 })
          .numbers("accel_position", &S::accel_position, "m", kAnyNumber,
                   "of the accelerometer from the centre of gravity: forward, left, up")
          .flag("feels_gravity", &S::feels_gravity, "the accelerometer rolls and pitches with the body");
  return table;
}

}  // namespace

std::vector<StudyKeys> drive_sensor_keys() { return all_of(keys_of_set(), keys_of_sensor("1")); }

DriveSensorSet read_drive_sensors(const StudyTable& table) {
  DriveSensorSet set = reference_drive_sensors();
  keys_of_set().read(table, set);
  for (const DriveSensorKind kind : enumerators<DriveSensorKind, kDriveSensors>()) {
    if (!table.has(kDriveSensorNames[kind])) continue;
    set[kind].enabled = true;
    keys_of_sensor(kDriveSensorUnits[kind]).read(table.table(kDriveSensorNames[kind]), set[kind]);
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
