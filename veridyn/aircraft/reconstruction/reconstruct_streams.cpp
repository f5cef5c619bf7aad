#include "veridyn/aircraft/reconstruction/reconstruct_streams.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/recording/lever_arm.hpp"

namespace veridyn::aircraft::internal {
namespace {

constexpr double kGasConstant = 287.05287;      // J/(kg K), ISO 2533
constexpr double kSeaLevelPressure = 101325.0;  // Pa
constexpr double kSeaLevelTemperature = 288.15;
constexpr double kSeaLevelDensity = 1.225;
constexpr double kLapse = 0.0065;
constexpr double kPressureExponent = kGravity / (kGasConstant * kLapse);

double median_interval(std::span<const double> t) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < t.size(); ++i) {
    if (t[i] > t[i - 1]) steps.push_back(t[i] - t[i - 1]);
  }
  return steps.empty() ? 0.0 : numerics::median(steps);
}

Stream scalar(const Recording& recording, const char* name, const char* unit, double delay) {
  Stream s;
  s.channel = name;
  s.unit = unit;
  const Channel* channel = recording.find(name);
  if (channel == nullptr) return s;
  const auto t = channel->times();
  s.t.reserve(t.size());
  s.v.reserve(t.size());
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (!std::isfinite(channel->value[i])) continue;
    s.t.push_back(t[i] - delay);
    s.v.push_back(channel->value[i]);
  }
  const double interval = median_interval(s.t);
  s.rate_Hz = interval > 0.0 ? 1.0 / interval : 0.0;
  return s;
}

double interpolate(std::span<const double> t, std::span<const double> v, double at, std::size_t& cursor) {
  while (cursor > 0 && t[cursor] > at) --cursor;
  while (cursor + 1 < t.size() && t[cursor + 1] <= at) ++cursor;
  if (cursor + 1 >= t.size() || at <= t[cursor]) return v[cursor];
  const double f = (at - t[cursor]) / (t[cursor + 1] - t[cursor]);
  return v[cursor] + f * (v[cursor + 1] - v[cursor]);
}

VectorStream vector(const Recording& recording, const std::string& stem) {
  std::array<Stream, 3> axis;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string name = stem + "_" + "xyz"[i];
    static_cast<void>(recording.at(name));  // throws naming what there is instead
    axis[i] = scalar(recording, name.c_str(), "", 0.0);
    if (axis[i].t.size() < 2) {
      throw InputError(recording.source, fmt::format("channel '{}' holds {} finite samples; reconstruction needs it",
                                                     name, axis[i].t.size()));
    }
  }
  VectorStream s;
  const bool together = axis[1].t == axis[0].t && axis[2].t == axis[0].t;
  std::size_t at_y = 0, at_z = 0;
  for (std::size_t i = 0; i < axis[0].t.size(); ++i) {
    const double t = axis[0].t[i];
    if (!s.t.empty() && !(t > s.t.back())) continue;  // a doubled stamp
    s.t.push_back(t);
    s.v.emplace_back(axis[0].v[i], together ? axis[1].v[i] : interpolate(axis[1].t, axis[1].v, t, at_y),
                     together ? axis[2].v[i] : interpolate(axis[2].t, axis[2].v, t, at_z));
  }
  s.interval = median_interval(s.t);
  return s;
}

bool has_accelerometer(const Recording& recording) {
  return recording.has("accel_x") && recording.has("accel_y") && recording.has("accel_z");
}

/// White noise per sample from third differences, which take away everything that is smooth; robust against spikes.
/// Samples that repeat their predecessor (a slow sensor logged fast) are passed over.
double noise_floor(std::span<const double> v) {
  std::vector<double> x, d;
  for (const double value : v) {
    if (x.empty() || value != x.back()) x.push_back(value);
  }
  for (std::size_t i = 3; i < x.size(); ++i) d.push_back(x[i] - 3.0 * x[i - 1] + 3.0 * x[i - 2] - x[i - 3]);
  if (d.size() < 20) return 0.0;
  return numerics::robust_sd(d) / std::sqrt(20.0);
}

double noise_floor(const VectorStream& s) {
  double largest = 0.0;
  std::vector<double> x(s.v.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < s.v.size(); ++i) x[i] = s.v[i](axis);
    largest = std::max(largest, noise_floor(x));
  }
  return largest;
}

SensorSigma choose_sigma(const FlightStreams& s, const ReconstructOptions& o) {
  SensorSigma sigma;
  if (o.sensors == NoiseSource::kMeasured) {
    const auto floor_of = [&](std::initializer_list<Sensor> which) {
      double largest = 0.0;
      for (const Sensor i : which) largest = std::max(largest, noise_floor(s.sensors[i].v));
      return largest;
    };
    sigma = autopilot_floor();
    sigma.accelerometer = std::max(sigma.accelerometer, noise_floor(s.accel));
    sigma.gyro = std::max(sigma.gyro, noise_floor(s.gyro));
    sigma.attitude = std::max(sigma.attitude, floor_of({kRoll, kPitch}));
    sigma.velocity = std::max(sigma.velocity, floor_of({kVelNorth, kVelEast}));
    sigma.velocity_down = std::max(sigma.velocity_down, floor_of({kVelDown}));
    (s.pitot_is_pressure ? sigma.dynamic_pressure : sigma.airspeed) =
        std::max(s.pitot_is_pressure ? sigma.dynamic_pressure : sigma.airspeed, floor_of({kPitot}));
    sigma.alpha = std::max(sigma.alpha, floor_of({kAlpha}));
    sigma.beta = std::max(sigma.beta, floor_of({kBeta}));
  }
  sigma.accelerometer = o.sigma.accelerometer.value_or(sigma.accelerometer);
  sigma.gyro = o.sigma.gyro.value_or(sigma.gyro);
  sigma.attitude = o.sigma.attitude.value_or(sigma.attitude);
  sigma.velocity = o.sigma.velocity.value_or(sigma.velocity);
  sigma.velocity_down = o.sigma.velocity_down.value_or(sigma.velocity_down);
  sigma.dynamic_pressure = o.sigma.dynamic_pressure.value_or(sigma.dynamic_pressure);
  sigma.airspeed = o.sigma.airspeed.value_or(sigma.airspeed);
  sigma.alpha = o.sigma.alpha.value_or(sigma.alpha);
  sigma.beta = o.sigma.beta.value_or(sigma.beta);
  return sigma;
}

double isa_temperature(double altitude) { return kSeaLevelTemperature - kLapse * std::min(altitude, 11000.0); }

void load_density(const Recording& recording, FlightStreams& s) {
  const auto put = [&](Stream stream, std::string origin) {
    s.density_t = std::move(stream.t);
    s.density = std::move(stream.v);
    s.density_origin = std::move(origin);
  };
  Stream density = scalar(recording, "air_density", "kg/m^3", 0.0);
  if (!density.t.empty()) return put(std::move(density), "channel air_density");
  Stream pressure = scalar(recording, "static_pressure", "Pa", 0.0);
  if (!pressure.t.empty() && numerics::median(pressure.v) > 1e4) {
    const Stream temperature = scalar(recording, "air_temperature", "K", 0.0);
    const bool measured = !temperature.t.empty() && numerics::median(temperature.v) > 150.0;
    std::size_t cursor = 0;
    for (std::size_t i = 0; i < pressure.t.size(); ++i) {
      const double p = std::max(pressure.v[i], 1e4);
      const double T = measured ? interpolate(temperature.t, temperature.v, pressure.t[i], cursor)
                                : kSeaLevelTemperature * std::pow(p / kSeaLevelPressure, 1.0 / kPressureExponent);
      pressure.v[i] = p / (kGasConstant * T);
    }
    return put(std::move(pressure), measured ? "static pressure and air temperature"
                                             : "static pressure, temperature of the standard atmosphere");
  }
  Stream altitude = scalar(recording, "alt", "m", 0.0);
  if (!altitude.t.empty()) {
    for (double& h : altitude.v) {
      const double T = isa_temperature(h);
      h = kSeaLevelPressure * std::pow(T / kSeaLevelTemperature, kPressureExponent) / (kGasConstant * T);
    }
    return put(std::move(altitude), "altitude in the standard atmosphere");
  }
  s.density_t = {0.0};
  s.density = {kSeaLevelDensity};
  s.density_origin = "standard atmosphere at sea level";
  s.warnings.emplace_back(
      "the recording holds neither air density, static pressure nor altitude: 1.225 kg/m^3 is assumed, an airspeed "
      "error of 5 % per 1000 m of altitude");
}

}  // namespace

Eigen::Vector3d VectorStream::at(double time, std::size_t& cursor) const {
  while (cursor > 0 && t[cursor] > time) --cursor;
  while (cursor + 1 < t.size() && t[cursor + 1] <= time) ++cursor;
  if (cursor + 1 >= t.size() || time <= t[cursor]) return v[cursor];
  const double f = (time - t[cursor]) / (t[cursor + 1] - t[cursor]);
  return v[cursor] + f * (v[cursor + 1] - v[cursor]);
}

double FlightStreams::density_at(double time, std::size_t& cursor) const {
  return interpolate(density_t, density, time, cursor);
}

double FlightStreams::density_at(double time) const {
  const auto after = std::upper_bound(density_t.begin(), density_t.end(), time) - density_t.begin();
  auto cursor = static_cast<std::size_t>(std::max<std::ptrdiff_t>(after, 1) - 1);
  return density_at(time, cursor);
}

DelayAlignment alignment_of(const Recording& recording, DelayAlignment alignment, const ReconstructOptions& options) {
  FlightStreams air;
  load_density(recording, air);
  alignment.air_density = numerics::median(air.density);
  alignment.airspeed_is_true = options.airspeed_is_true;
  alignment.vane_position = options.vane_position;
  return alignment;
}

FlightStreams load_streams(const Recording& recording, const ReconstructOptions& o) {
  FlightStreams s;
  s.gyro = vector(recording, "gyro");
  if (has_accelerometer(recording)) s.accel = vector(recording, "accel");
  s.sensors[kRoll] = scalar(recording, "roll", "rad", o.delay.attitude);
  s.sensors[kPitch] = scalar(recording, "pitch", "rad", o.delay.attitude);
  s.sensors[kYaw] = scalar(recording, "yaw", "rad", o.delay.attitude);
  s.sensors[kVelNorth] = scalar(recording, "vel_north", "m/s", o.delay.velocity);
  s.sensors[kVelEast] = scalar(recording, "vel_east", "m/s", o.delay.velocity);
  s.sensors[kVelDown] = scalar(recording, "vel_down", "m/s", o.delay.velocity);
  load_density(recording, s);

  s.sensors[kPitot] = scalar(recording, "dynamic_pressure", "Pa", o.delay.pitot);
  if (s.sensors[kPitot].t.empty()) {
    s.pitot_is_pressure = false;
    s.sensors[kPitot] = scalar(recording, "airspeed", "m/s", o.delay.pitot);
    if (!o.airspeed_is_true) {
      std::size_t cursor = 0;
      for (std::size_t i = 0; i < s.sensors[kPitot].t.size(); ++i) {
        s.sensors[kPitot].v[i] *= std::sqrt(kSeaLevelDensity / s.density_at(s.sensors[kPitot].t[i], cursor));
      }
    }
  }
  s.sensors[kAlpha] = scalar(recording, "alpha", "rad", o.delay.alpha);
  s.sensors[kBeta] = scalar(recording, "beta", "rad", o.delay.beta);
  const auto drop = [&](Sensor which, bool use) {
    if (use) return;
    s.sensors[which].t.clear();
    s.sensors[which].v.clear();
  };
  drop(kPitot, o.use_pitot);
  drop(kAlpha, o.use_alpha);
  drop(kBeta, o.use_beta);

  s.sigma = choose_sigma(s, o);
  const SensorSigma& q = s.sigma;
  const EnumArray<Sensor, double, kSensors> sigma{{q.attitude, q.attitude, q.attitude, q.velocity, q.velocity,
                                                   q.velocity_down,
                                                   s.pitot_is_pressure ? q.dynamic_pressure : q.airspeed, q.alpha,
                                                   q.beta, q.accelerometer, q.accelerometer, q.accelerometer}};
  for (std::size_t i = 0; i < kSensors; ++i) s.sensors[i].sigma = sigma[i];
  return s;
}

Controls<double> ControlStreams::at(double time, Cursor& cursor) const {
  const auto value = [&](const Stream& s, std::size_t i) {
    return s.t.empty() ? 0.0 : interpolate(s.t, s.v, time, cursor.position[i]);
  };
  Controls<double> c;
  c.de = value(elevator, 0);
  c.da = value(aileron, 1);
  c.dr = value(rudder, 2);
  c.throttle = value(throttle, 3);
  c.rotor_speed = value(rotor_speed, 4);
  return c;
}

namespace {

constexpr std::array<Coefficient, 3> kForces{Coefficient::kCL, Coefficient::kCD, Coefficient::kCY};

bool uses(const Subject& subject, AeroVariable variable) {
  for (const Coefficient c : kForces) {
    const CoefficientModel* model = subject.model.find(c);
    if (model == nullptr) continue;
    for (const Term& term : model->terms) {
      if (term.uses(variable)) return true;
    }
  }
  return false;
}

/// The accelerometer's readings without what the sensor's place adds: a_cg = a - w' x r - w x (w x r), the angular
/// acceleration by central differences of the gyro.
void move_to_centre_of_gravity(FlightStreams& s, const std::array<double, 3>& position) {
  const Eigen::Vector3d r(position[0], position[1], position[2]);
  if (r.norm() == 0.0) return;
  std::size_t before = 0, here = 0, after = 0;
  const double h = s.gyro.interval;
  for (std::size_t i = 0; i < s.accel.t.size(); ++i) {
    const double t = s.accel.t[i];
    const Eigen::Vector3d w = s.gyro.at(t, here);
    const Eigen::Vector3d rate = (s.gyro.at(t + h, after) - s.gyro.at(t - h, before)) / (2.0 * h);
    s.accel.v[i] -= recording::lever_arm_acceleration(rate, w, r);
  }
}

}  // namespace

ModelStreams load_model_streams(const Recording& recording, Subject subject, FlightStreams s,
                                const std::string& needing) {
  for (const Coefficient c : {Coefficient::kCl, Coefficient::kCm, Coefficient::kCn}) {
    subject.model.coefficients[c].reset();
  }
  for (const Coefficient c : kForces) {
    CoefficientModel* model = subject.model.find(c);
    if (model == nullptr || model->known()) continue;
    if (c == Coefficient::kCL) break;
    subject.model.coefficients[c].reset();
  }
  const CoefficientModel* lift = subject.model.find(Coefficient::kCL);
  if (lift == nullptr || !lift->known()) {
    throw InputError(recording.source,
                     fmt::format("{} needs the derivatives of CL: values in subject.model.CL or an identified CL in "
                                 "reconstruct.estimate_file",
                                 needing));
  }
  for (const Coefficient c : {Coefficient::kCD, Coefficient::kCY}) {
    if (subject.model.find(c) == nullptr) {
      s.warnings.push_back(fmt::format(
          "the derivatives of {} are not known: its force is taken as the accelerometer shows it", name_of(c)));
    }
  }
  const auto surface = [&](const char* name, AeroVariable variable, Stream& stream) {
    stream = scalar(recording, name, "rad", 0.0);
    if (!stream.t.empty() || !uses(subject, variable)) return;
    throw InputError(recording.source,
                     fmt::format("has no channel '{}', which the force model of {} depends on", name, needing));
  };
  surface("elevator", AeroVariable::kDe, s.controls.elevator);
  surface("aileron", AeroVariable::kDa, s.controls.aileron);
  surface("rudder", AeroVariable::kDr, s.controls.rudder);

  Stream thrust = scalar(recording, "thrust", "N", 0.0);
  Stream throttle = scalar(recording, "throttle", "1", 0.0);
  if (!thrust.t.empty()) {
    // A propulsion whose throttle is the thrust.
    const std::array<double, 3> position = subject.propulsion.position;
    subject.propulsion = {};
    subject.propulsion.kind = PropulsionKind::kPolynomial;
    subject.propulsion.position = position;
    subject.propulsion.polynomial = {{1, 0, 1.0}};
    s.controls.throttle = std::move(thrust);
  } else if (subject.propulsion.kind != PropulsionKind::kNone) {
    if (throttle.t.empty()) {
      throw InputError(recording.source, fmt::format("has neither 'thrust' nor 'throttle'; {} needs one", needing));
    }
    Stream rotor = throttle;
    double speed = kNaN;
    for (std::size_t i = 0; i < throttle.t.size(); ++i) {
      const double steady = subject.propulsion.steady_rotor_speed(throttle.v[i]);
      const bool lags = subject.propulsion.kind == PropulsionKind::kPropeller && std::isfinite(speed);
      const double step = i > 0 ? throttle.t[i] - throttle.t[i - 1] : 0.0;
      speed = lags ? steady + (speed - steady) * std::exp(-step / subject.propulsion.time_constant) : steady;
      rotor.v[i] = speed;
    }
    s.controls.throttle = std::move(throttle);
    s.controls.rotor_speed = std::move(rotor);
  } else {
    s.warnings.push_back(
        fmt::format("{} has no propulsion model and the recording no thrust: taken as 0", subject.name));
  }

  move_to_centre_of_gravity(s, subject.imu_position);
  const std::array<const char*, 3> names{"accel_x", "accel_y", "accel_z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Stream& stream = s.sensors[kAccelX + axis];
    stream.channel = names[axis];
    stream.unit = "m/s^2";
    stream.t = s.accel.t;
    stream.v.clear();
    for (const Eigen::Vector3d& a : s.accel.v) stream.v.push_back(a(axis));
    stream.rate_Hz = s.accel.interval > 0.0 ? 1.0 / s.accel.interval : 0.0;
    stream.sigma = s.sigma.accelerometer;
  }
  return {std::move(s), std::move(subject)};
}

std::vector<Segment> find_segments(const FlightStreams& s, double max_gap) {
  const auto pieces = [max_gap](const std::vector<double>& t) {
    std::vector<Segment> out;
    std::size_t first = 0;
    for (std::size_t i = 1; i <= t.size(); ++i) {
      if (i < t.size() && t[i] - t[i - 1] <= max_gap) continue;
      out.push_back({t[first], t[i - 1]});
      first = i;
    }
    return out;
  };
  std::vector<Segment> found;
  const std::vector<Segment> by_accel = pieces(s.accel.t);
  for (const Segment& g : pieces(s.gyro.t)) {
    for (const Segment& a : by_accel) {
      Segment both{std::max(g.begin, a.begin), std::min(g.end, a.end)};
      for (const Sensor i : {kRoll, kPitch, kYaw, kVelNorth, kVelEast, kVelDown}) {
        const auto& t = s.sensors[i].t;
        if (t.empty()) continue;
        const auto it = std::lower_bound(t.begin(), t.end(), both.begin);
        both.begin = std::max(both.begin, it == t.end() ? both.end : *it);
      }
      // Too short to estimate anything: a second, or ten samples.
      if (both.end - both.begin >= std::max(1.0, 10.0 * s.gyro.interval)) found.push_back(both);
    }
  }
  return found;
}

}  // namespace veridyn::aircraft::internal
