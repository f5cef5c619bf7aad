#include "veridyn/vehicle/manoeuvre/manoeuvre.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/random.hpp"
#include "veridyn/vehicle/manoeuvre/driver_model.hpp"
#include "veridyn/vehicle/manoeuvre/turn_braking_driver.hpp"

namespace veridyn::vehicle {
namespace {

class SignalDriver final : public Driver {
 public:
  explicit SignalDriver(PiecewiseLinear steer, PiecewiseLinear drive = {}, PiecewiseLinear brake = {})
      : steer_(std::move(steer)), drive_(std::move(drive)), brake_(std::move(brake)) {}
  [[nodiscard]] Controls controls(double time) const override { return {steer_(time), drive_(time), brake_(time)}; }

 private:
  PiecewiseLinear steer_, drive_, brake_;
};

/// Whole periods of a sine; with a dwell it holds its second peak.
class SineDriver final : public Driver {
 public:
  SineDriver(double amplitude, double frequency, double start, double periods, double dwell)
      : amplitude_(amplitude), frequency_(frequency), start_(start), periods_(periods), dwell_(dwell) {}
  [[nodiscard]] Controls controls(double time) const override {
    double t = time - start_;
    const double peak = 0.75 / frequency_;
    if (dwell_ > 0.0 && t > peak) t = std::max(peak, t - dwell_);
    if (t <= 0.0 || t * frequency_ >= periods_) return {};
    return {.steer = amplitude_ * std::sin(2.0 * kPi * frequency_ * t)};
  }

 private:
  double amplitude_, frequency_, start_, periods_, dwell_;
};

/// Steers as another and adds torques.
class TorqueDriver final : public Driver {
 public:
  TorqueDriver(std::unique_ptr<Driver> steering, PiecewiseLinear drive, PiecewiseLinear brake)
      : steering_(std::move(steering)), drive_(std::move(drive)), brake_(std::move(brake)) {}
  void look(double time, const PlanarMotion& motion) override { steering_->look(time, motion); }
  [[nodiscard]] Controls controls(double time) const override {
    Controls c = steering_->controls(time);
    c.drive_torque += drive_(time);
    c.brake_torque += brake_(time);
    return c;
  }

 private:
  std::unique_ptr<Driver> steering_;
  PiecewiseLinear drive_, brake_;
};

/// Half a cosine from 0 to 1 while x goes from 0 to 1.
double smooth(double x) { return 0.5 * (1.0 - std::cos(kPi * std::clamp(x, 0.0, 1.0))); }

class SweepDriver final : public Driver {
 public:
  SweepDriver(double amplitude, double low, double high, double duration, double start)
      : amplitude_(amplitude), low_(low), duration_(duration), start_(start), growth_(std::log(high / low)) {}
  [[nodiscard]] Controls controls(double time) const override {
    const double t = time - start_;
    if (t <= 0.0 || t >= duration_) return {};
    const double phase = 2.0 * kPi * low_ * duration_ / growth_ * std::expm1(growth_ * t / duration_);
    return {.steer = amplitude_ * smooth((duration_ - t) / kFade) * std::sin(phase)};
  }

 private:
  static constexpr double kFade = 0.5;
  double amplitude_, low_, duration_, start_, growth_;
};

void require(bool good, const char* name, double value, const char* unit, const char* rule) {
  if (!good)
    throw InputError("manoeuvre", fmt::format("{} is {:g}{}{}; must be {}", name, value, *unit ? " " : "", unit, rule));
}
void require_steer(double amplitude) {
  require(std::abs(amplitude) < kPi / 2.0, "steer", amplitude / kDegree, "deg", "within 90 deg");
}
void require_positive(double value, const char* name, const char* unit) {
  require(value > 0.0 && std::isfinite(value), name, value, unit, "> 0");
}
void require_start(double start) { require(start >= 0.0 && std::isfinite(start), "start", start, "s", ">= 0"); }

Manoeuvre with(ManoeuvreKind kind, std::unique_ptr<Driver> driver, double duration, double start, double amplitude) {
  Manoeuvre manoeuvre;
  manoeuvre.kind = kind;
  manoeuvre.driver = std::move(driver);
  manoeuvre.default_duration = duration;
  manoeuvre.start = start;
  manoeuvre.amplitude = amplitude;
  return manoeuvre;
}

}  // namespace

std::string_view to_string(ManoeuvreKind kind) {
  switch (kind) {
    case ManoeuvreKind::kReference:
      return "reference";
    case ManoeuvreKind::kStepSteer:
      return "step steer";
    case ManoeuvreKind::kSine:
      return "sine";
    case ManoeuvreKind::kContinuousSine:
      return "continuous sine";
    case ManoeuvreKind::kSineWithDwell:
      return "sine with dwell";
    case ManoeuvreKind::kSweep:
      return "sweep";
    case ManoeuvreKind::kRandomSteer:
      return "random steer";
    case ManoeuvreKind::kFishhook:
      return "fishhook";
    case ManoeuvreKind::kSteadyStateCircle:
      return "steady-state circle";
    case ManoeuvreKind::kDoubleLaneChange:
      return "double lane change";
    case ManoeuvreKind::kObstacleAvoidance:
      return "obstacle avoidance";
    case ManoeuvreKind::kSlalom:
      return "slalom";
    case ManoeuvreKind::kRampSteer:
      return "ramp steer";
    case ManoeuvreKind::kBrakingInATurn:
      return "braking in a turn";
    case ManoeuvreKind::kFollowPath:
      return "follow path";
    case ManoeuvreKind::kSignal:
      return "signal";
  }
  return "";
}

Manoeuvre reference_manoeuvre() {
  const double delta = 5.0 * kDegree;
  Manoeuvre m = with(ManoeuvreKind::kReference,
                     std::make_unique<SignalDriver>(PiecewiseLinear({2.0, 3.0, 15.0, 16.0}, {0.0, delta, delta, 0.0})),
                     20.0, 2.0, delta);
  m.rise_time = 1.0;
  return m;
}

Manoeuvre step_steer(double amplitude, double start, double rise_time) {
  require_steer(amplitude);
  require_start(start);
  require_positive(rise_time, "rise_time", "s");
  Manoeuvre m = with(ManoeuvreKind::kStepSteer,
                     std::make_unique<SignalDriver>(PiecewiseLinear({start, start + rise_time}, {0.0, amplitude})),
                     start + 7.0, start, amplitude);
  m.rise_time = rise_time;
  return m;
}

Manoeuvre sine_steer(double amplitude, double frequency, double start, int periods) {
  require_steer(amplitude);
  require_start(start);
  require_positive(frequency, "frequency", "Hz");
  require(periods >= 1, "periods", periods, "", ">= 1");
  Manoeuvre m = with(periods == 1 ? ManoeuvreKind::kSine : ManoeuvreKind::kContinuousSine,
                     std::make_unique<SineDriver>(amplitude, frequency, start, periods, 0.0),
                     start + periods / frequency + 4.0, start, amplitude);
  m.frequency = m.end_frequency = frequency;
  return m;
}

Manoeuvre sine_with_dwell(double amplitude, double start, double frequency, double dwell) {
  require_steer(amplitude);
  require_start(start);
  require_positive(frequency, "frequency", "Hz");
  require(dwell >= 0.0, "dwell", dwell, "s", ">= 0");
  Manoeuvre m =
      with(ManoeuvreKind::kSineWithDwell, std::make_unique<SineDriver>(amplitude, frequency, start, 1.0, dwell),
           start + 1.0 / frequency + dwell + 4.0, start, amplitude);
  m.frequency = m.end_frequency = frequency;
  return m;
}

Manoeuvre sweep_steer(double amplitude, double low, double high, double duration, double start) {
  require_steer(amplitude);
  require_start(start);
  require_positive(low, "low", "Hz");
  require(high > low && std::isfinite(high), "high", high, "Hz", "> low");
  require_positive(duration, "length", "s");
  Manoeuvre m = with(ManoeuvreKind::kSweep, std::make_unique<SweepDriver>(amplitude, low, high, duration, start),
                     start + duration + 2.0, start, amplitude);
  m.frequency = low;
  m.end_frequency = high;
  return m;
}

Manoeuvre random_steer(double amplitude, double low, double high, double duration, std::uint64_t seed, double start) {
  return random_steer(amplitude, low, high, duration, seed, start, Progress());
}

Manoeuvre random_steer(double amplitude, double low, double high, double duration, std::uint64_t seed, double start,
                       const Progress& progress) {
  require_steer(amplitude);
  require_start(start);
  require_positive(low, "low", "Hz");
  require(high > low && std::isfinite(high), "high", high, "Hz", "> low");
  require(duration * low >= 1.0 && std::isfinite(duration), "length", duration, "s",
          "at least one period of the lowest frequency");
  const auto first = static_cast<int>(std::ceil(low * duration - 1e-9));
  const auto last = static_cast<int>(std::floor(high * duration + 1e-9));
  numerics::RandomStream random(seed, "random steer");
  std::vector<double> phase;
  for (int k = first; k <= last; ++k) phase.push_back(random.uniform(0.0, 2.0 * kPi));
  // Straight between 50 samples of the shortest period; cosines by rotation, one a harmonic, would be quicker, but this
  // is done once.
  const auto samples = static_cast<std::size_t>(std::ceil(50.0 * high * duration));
  std::vector<double> time(samples + 1), value(samples + 1);
  double peak = 0.0;
  constexpr double kFade = 1.0;
  for (std::size_t i = 0; i <= samples; ++i) {
    const double t = duration * static_cast<double>(i) / static_cast<double>(samples);
    time[i] = start + t;
    if (progress.interrupted()) continue;
    double sum = 0.0;
    for (int k = first; k <= last; ++k) {
      sum += std::cos(2.0 * kPi * k * t / duration + phase[k - first]);
    }
    value[i] = sum * smooth(t / kFade) * smooth((duration - t) / kFade);
    peak = std::max(peak, std::abs(value[i]));
  }
  for (double& one : value) one *= peak > 0.0 ? amplitude / peak : 0.0;
  Manoeuvre m = with(ManoeuvreKind::kRandomSteer,
                     std::make_unique<SignalDriver>(PiecewiseLinear(std::move(time), std::move(value))),
                     start + duration + 2.0, start, amplitude);
  m.frequency = low;
  m.end_frequency = high;
  return m;
}

Manoeuvre fishhook(double amplitude, double rate, double start, double dwell) {
  require_steer(amplitude);
  require_start(start);
  require(amplitude != 0.0, "steer", 0.0, "deg", "other than 0");
  require_positive(rate, "rate", "rad/s");
  require_positive(dwell, "dwell", "s");
  const double ramp = std::abs(amplitude) / rate;
  const double second = start + ramp + dwell;
  const double held = second + 2.0 * ramp;
  PiecewiseLinear steer({start, start + ramp, second, held, held + 3.0, held + 5.0},
                        {0.0, amplitude, amplitude, -amplitude, -amplitude, 0.0});
  return with(ManoeuvreKind::kFishhook, std::make_unique<SignalDriver>(std::move(steer)), held + 7.0, start, amplitude);
}

Manoeuvre slowly_increasing_steer(double amplitude, double rate, double start) {
  require_steer(amplitude);
  require_start(start);
  require(amplitude != 0.0, "steer", 0.0, "deg", "other than 0");
  require_positive(rate, "rate", "rad/s");
  const double ramp = std::abs(amplitude) / rate;
  Manoeuvre m = with(ManoeuvreKind::kSteadyStateCircle,
                     std::make_unique<SignalDriver>(PiecewiseLinear({start, start + ramp}, {0.0, amplitude})),
                     start + ramp, start, amplitude);
  m.rise_time = ramp;
  return m;
}

Manoeuvre ramp_steer(double amplitude, double rate, double start, double hold) {
  require(hold >= 0.0 && std::isfinite(hold), "hold", hold, "s", ">= 0");
  Manoeuvre m = slowly_increasing_steer(amplitude, rate, start);
  m.kind = ManoeuvreKind::kRampSteer;
  m.default_duration += hold;
  return m;
}

Manoeuvre steering_signal(PiecewiseLinear steer, PiecewiseLinear drive_torque, PiecewiseLinear brake_torque) {
  if (steer.empty()) throw InputError("manoeuvre", "the steering signal has no samples");
  double peak = 0.0;
  for (const double angle : steer.values()) {
    require_steer(angle);
    peak = std::max(peak, std::abs(angle));
  }
  for (const double torque : brake_torque.values()) require(torque >= 0.0, "brake_torque", torque, "N m", ">= 0");
  const double begin = steer.times().front(), end = steer.times().back();
  return with(ManoeuvreKind::kSignal,
              std::make_unique<SignalDriver>(std::move(steer), std::move(drive_torque), std::move(brake_torque)),
              end > 0.0 ? end : 20.0, begin, peak);
}

Manoeuvre with_torques(Manoeuvre manoeuvre, PiecewiseLinear drive_torque, PiecewiseLinear brake_torque) {
  for (const double torque : brake_torque.values()) require(torque >= 0.0, "brake_torque", torque, "N m", ">= 0");
  manoeuvre.driver =
      std::make_unique<TorqueDriver>(std::move(manoeuvre.driver), std::move(drive_torque), std::move(brake_torque));
  return manoeuvre;
}

Manoeuvre with_speed_control(Manoeuvre manoeuvre, PiecewiseLinear speed, const ManoeuvreContext& context) {
  for (const double u : speed.values()) require_positive(u, "target_speed", "m/s");
  manoeuvre.speed = speed;
  manoeuvre.driver = std::make_unique<SpeedControlledDriver>(
      std::move(manoeuvre.driver), std::move(speed),
      SpeedControllerOptions{.mass = context.parameters.mass, .wheel_radius = context.wheel_radius});
  return manoeuvre;
}

LinearBicycle<double> expected_bicycle(const ManoeuvreContext& context) {
  require_positive(context.speed, "speed", "m/s");
  const VehicleParameters<double>& p = context.parameters;
  return {p.mass, p.I_z, p.a, p.b, context.C_f.value_or(p.C_f), context.C_r.value_or(p.C_r), context.speed};
}

Manoeuvre follow_path(const ManoeuvreContext& context, std::shared_ptr<const Path> path,
                      const PreviewDriverOptions& options) {
  path = std::make_shared<const Path>(path->from_origin());
  Manoeuvre m =
      with(ManoeuvreKind::kFollowPath, std::make_unique<PreviewDriver>(expected_bicycle(context), path, options),
           path->length() / context.speed, 0.0, options.max_steer);
  m.path = std::move(path);
  return m;
}

namespace {

double body_width(const VehicleParameters<double>& p, double given) {
  return given == 0.0 ? 7.0 / 6.0 * std::max(p.track_f, p.track_r) : given;
}

/// A path between cones for a body of this width.
Manoeuvre between_cones(ManoeuvreKind kind, const ManoeuvreContext& context, const Path& path, double width,
                        const PreviewDriverOptions& options) {
  Manoeuvre m = follow_path(context, std::make_shared<const Path>(path), options);
  m.kind = kind;
  m.body = {.ahead = context.parameters.a, .behind = context.parameters.b, .width = width};
  return m;
}

}  // namespace

Manoeuvre double_lane_change(const ManoeuvreContext& context, double vehicle_width, double course_scale,
                             const PreviewDriverOptions& options) {
  DoubleLaneChange course = iso_double_lane_change(body_width(context.parameters, vehicle_width), course_scale);
  Manoeuvre m = between_cones(ManoeuvreKind::kDoubleLaneChange, context, course.path, course.vehicle_width, options);
  m.course = std::move(course);
  return m;
}

Manoeuvre obstacle_avoidance(const ManoeuvreContext& context, double vehicle_width, double course_scale,
                             const PreviewDriverOptions& options) {
  DoubleLaneChange course = iso_obstacle_avoidance(body_width(context.parameters, vehicle_width), course_scale);
  Manoeuvre m = between_cones(ManoeuvreKind::kObstacleAvoidance, context, course.path, course.vehicle_width, options);
  m.course = std::move(course);
  return m;
}

Manoeuvre slalom(const ManoeuvreContext& context, Slalom course, const PreviewDriverOptions& options) {
  Manoeuvre m = between_cones(ManoeuvreKind::kSlalom, context, course.path, course.vehicle_width, options);
  m.slalom = std::move(course);
  return m;
}

Manoeuvre braking_in_a_turn(const ManoeuvreContext& context, double radius, double deceleration, double brake_time,
                            const PreviewDriverOptions& options) {
  require_positive(deceleration, "deceleration", "m/s^2");
  require_positive(brake_time, "brake_time", "s");
  Manoeuvre m = constant_radius_circle(context, radius, context.speed, brake_time, options);
  m.kind = ManoeuvreKind::kBrakingInATurn;
  m.driver = std::make_unique<TurnBrakingDriver>(
      std::move(m.driver),
      TurnBrakingOptions{.brake_time = brake_time,
                         .brake_torque = context.parameters.mass * deceleration * context.wheel_radius});
  m.brake_time = brake_time;
  m.default_duration = brake_time + context.speed / deceleration;
  return m;
}

Manoeuvre constant_radius_circle(const ManoeuvreContext& context, double radius, double end_speed, double duration,
                                 const PreviewDriverOptions& options) {
  require(std::abs(radius) > 0.0 && std::isfinite(radius), "radius", radius, "m", "other than 0");
  require_positive(end_speed, "end_speed", "m/s");
  require_positive(duration, "length", "s");
  Manoeuvre m = follow_path(
      context, std::make_shared<const Path>(Path::circle(std::abs(radius), radius > 0.0 ? 1 : -1)), options);
  m.kind = ManoeuvreKind::kSteadyStateCircle;
  m.radius = radius;
  m.default_duration = duration;
  return with_speed_control(std::move(m), PiecewiseLinear({0.0, duration}, {context.speed, end_speed}), context);
}

}  // namespace veridyn::vehicle
