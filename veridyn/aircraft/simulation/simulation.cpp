#include "veridyn/aircraft/simulation/simulation.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "veridyn/aircraft/sensors/lost_rows.hpp"
#include "veridyn/aircraft/sensors/servo.hpp"
#include "veridyn/aircraft/simulation/autopilot.hpp"
#include "veridyn/aircraft/simulation/gust_gradients.hpp"
#include "veridyn/core/assert.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/numerics/ode.hpp"

namespace veridyn::aircraft {

namespace {

using Eigen::Vector3d;
using State = RigidBodyState<double>;

/// Field of the earth in central Europe, NED [T].
const Vector3d kMagneticField(20e-6, 1e-6, 44e-6);

void put(TruthSample& out, Truth first, const Vector3d& v) {
  const auto i = static_cast<std::size_t>(first);
  for (std::size_t k = 0; k < 3; ++k) out.value[i + k] = v(static_cast<Eigen::Index>(k));
}

/// State, controls and air at one moment.
struct Moment {
  State state;
  Controls<double> controls;
  Vector3d mean_wind;
  Vector3d gust;
  Vector3d gust_rates;
  double downwash_lag = 0.0;
  PerSurface<double> command{};
};

TruthSample truth_of(const Subject& s, const MassProperties& body, const Moment& m, double gravity) {
  TruthSample out;
  const State& x = m.state;
  const Eigen::Matrix3d R = R_body_from_ned(x);
  const Air<double> air = standard_atmosphere(-x(2));
  const Vector3d omega = x.tail<3>();
  const Vector3d v_r = R * (x.segment<3>(3) - m.mean_wind) - m.gust;
  const Vector3d rates = omega + m.gust_rates;
  const AeroLoads<double> loads = aero_loads<double>(s, v_r, rates, m.controls, air.density, m.downwash_lag);
  const State rate = rigid_body_rate<double>(x, body, loads.force, loads.moment, gravity);
  const auto euler = numerics::euler_from_quaternion(attitude_of(x));
  put(out, Truth::kPosNorth, x.head<3>());
  put(out, Truth::kVelNorth, x.segment<3>(3));
  put(out, Truth::kRoll, {euler.phi, euler.theta, euler.psi});
  put(out, Truth::kGyroX, omega);
  const Vector3d omega_rate = rate.tail<3>();
  put(out, Truth::kGyroRateX, omega_rate);
  const Vector3d accel = loads.force / s.mass;
  put(out, Truth::kAccelX, accel);
  const Vector3d arm(s.imu_position[0], s.imu_position[1], s.imu_position[2]);
  put(out, Truth::kImuAccelX, accel + omega.cross(omega.cross(arm)) + omega_rate.cross(arm));
  out[Truth::kAirspeed] = loads.air.Va;
  out[Truth::kAlpha] = loads.air.alpha;
  out[Truth::kBeta] = loads.air.beta;
  out[Truth::kDynamicPressure] = loads.dynamic_pressure;
  out[Truth::kStaticPressure] = air.pressure;
  out[Truth::kAirTemperature] = air.temperature;
  out[Truth::kAirDensity] = air.density;
  put(out, Truth::kWindNorth, m.mean_wind + R.transpose() * m.gust);
  put(out, Truth::kMeanWindNorth, m.mean_wind);
  put(out, Truth::kGustX, m.gust);
  out[Truth::kElevator] = m.controls.de;
  out[Truth::kAileron] = m.controls.da;
  out[Truth::kRudder] = m.controls.dr;
  out[Truth::kThrottle] = m.controls.throttle;
  out[Truth::kEngineSpeed] = m.controls.rotor_speed;
  out[Truth::kThrust] = loads.propulsion.thrust;
  out[Truth::kCL] = loads.coefficients.CL;
  out[Truth::kCD] = loads.coefficients.CD;
  out[Truth::kCY] = loads.coefficients.CY;
  const Vector3d engine(s.propulsion.position[0], s.propulsion.position[1], s.propulsion.position[2]);
  const Vector3d aero_moment =
      loads.moment - engine.cross(Vector3d(loads.propulsion.thrust, 0, 0)) - Vector3d(loads.propulsion.torque, 0, 0);
  const double qS = std::max(1e-9, loads.dynamic_pressure * s.wing_area);
  put(out, Truth::kCl,
      {aero_moment(0) / (qS * s.span), aero_moment(1) / (qS * s.chord), aero_moment(2) / (qS * s.span)});
  put(out, Truth::kForceX, loads.force);
  put(out, Truth::kMomentX, loads.moment);
  put(out, Truth::kMagX, R * kMagneticField);
  put(out, Truth::kGustRateX, m.gust_rates);
  out[Truth::kDownwashLag] = m.downwash_lag;
  out[Truth::kElevatorCommand] = m.command[Surface::kElevator];
  out[Truth::kAileronCommand] = m.command[Surface::kAileron];
  out[Truth::kRudderCommand] = m.command[Surface::kRudder];
  out[Truth::kThrottleCommand] = m.command[Surface::kThrottle];
  return out;
}

/// Whether the truth of a flight has such a channel: those of what it does not have are left out.
bool has_truth(const SimulationOptions& o, Truth t) {
  if (t >= Truth::kElevatorCommand) return o.log_commands;
  if (t == Truth::kDownwashLag) return o.subject.downwash.any();
  return t < Truth::kGustRateX || o.gust_gradients;
}

/// Collects samples of the truth for a recording.
class TruthRecorder {
 public:
  void add(double t, const TruthSample& sample) {
    time_.push_back(t);
    for (std::size_t i = 0; i < kTruthCount; ++i) value_[i].push_back(sample.value[i]);
  }
  void move_into(Recording& recording, const SimulationOptions& o) {
    const TimeBase base = make_time_base(std::move(time_));
    for (std::size_t i = 0; i < kTruthCount; ++i) {
      if (!has_truth(o, static_cast<Truth>(i))) continue;
      recording.add(
          make_channel(std::string(kTruthChannels[i].name), kTruthChannels[i].unit, base, std::move(value_[i])));
    }
  }

 private:
  std::vector<double> time_;
  EnumArray<Truth, std::vector<double>, kTruthCount> value_;
};

void check(const SimulationOptions& o) {
  const std::string place = fmt::format("subject '{}'", o.subject.name);
  if (!o.subject.inertia) throw InputError(place, "has no inertia: a simulation needs it (subject.inertia)");
  const std::vector<std::string> unknown = o.subject.model.unknown_parameters();
  if (!unknown.empty()) {
    throw InputError(place, fmt::format("has no values for {}: a simulation needs them", fmt::join(unknown, ", ")));
  }
  for (const Coefficient c : {Coefficient::kCL, Coefficient::kCD}) {
    if (o.subject.model.find(c) == nullptr) {
      throw InputError(place, fmt::format("has no model of {}: a simulation needs it", name_of(c)));
    }
  }
}

/// An aircraft in the air that it flies through: its state, the servos and the engine that move it, gusts and wind.
class FlyingAircraft {
 public:
  /// In steady flight at the trim; `options.changes` and the rest of the flight are up to the caller.
  FlyingAircraft(const SimulationOptions& options, const Trim& trim)
      : subject_(options.subject),
        body_(subject_.mass, subject_.inertia->matrix()),
        step_(options.step),
        gravity_(options.gravity),
        ground_(options.ground),
        rotor_share_(rotor_share(subject_.propulsion, step_)),
        servos_{Servo(subject_.elevator, trim.controls.de, step_), Servo(subject_.aileron, trim.controls.da, step_),
                Servo(subject_.rudder, trim.controls.dr, step_),
                Servo(subject_.throttle, trim.controls.throttle, step_)},
        gusts_(options.turbulence, numerics::RandomStream(options.seed, "turbulence")),
        gradients_(options.turbulence, subject_.span, numerics::RandomStream(options.seed, "gust gradients")),
        with_gradients_(options.gust_gradients && !options.turbulence.calm()),
        wind_(options.wind, numerics::RandomStream(options.seed, "wind")) {
    now_.controls = trim.controls;
    now_.mean_wind = wind_.at(options.altitude - ground_);
    now_.gust = gust_vector();
    now_.gust_rates = gust_rates();
    now_.command = PerSurface<double>{{trim.controls.de, trim.controls.da, trim.controls.dr, trim.controls.throttle}};
    now_.state.setZero();
    now_.state(2) = -options.altitude;
    now_.state.segment<4>(6) = numerics::quaternion_from_euler(0.0, trim.theta, options.heading).coeffs();
    now_.state.segment<3>(3) =
        R_body_from_ned(now_.state).transpose() * air_velocity(trim.condition.airspeed, trim.alpha, trim.beta) +
        now_.mean_wind;
  }

  void change_model(const AeroModel& model) { subject_.model = model; }

  [[nodiscard]] TruthSample truth() const { return truth_of(subject_, body_, now_, gravity_); }
  [[nodiscard]] bool finite() const { return now_.state.allFinite(); }

  /// Over one step from `t` [s], where the truth is `truth`, with the surfaces commanded to `command`.
  void advance(double t, const TruthSample& truth, const PerSurface<double>& command) {
    for (const Surface s : enumerators<Surface, kSurfaces>()) servos_[s].advance(command[s]);
    const double Va = truth[Truth::kAirspeed];
    const std::array<double, 3> gust_before = gusts_.gust();
    gusts_.advance(step_, Va);
    if (with_gradients_) gradients_.advance(step_, Va, gust_before, gusts_.gust());
    wind_.advance(step_);
    Moment next;
    next.command = within_stops(command);
    next.controls = {servos_[Surface::kElevator].position(), servos_[Surface::kAileron].position(),
                     servos_[Surface::kRudder].position(), servos_[Surface::kThrottle].position(), 0.0};
    next.controls.rotor_speed =
        now_.controls.rotor_speed +
        rotor_share_ * (subject_.propulsion.steady_rotor_speed(next.controls.throttle) - now_.controls.rotor_speed);
    next.mean_wind = wind_.at(-now_.state(2) - ground_);
    next.gust = gust_vector();
    next.gust_rates = gust_rates();

    // Density changes by less than 1e-5 of itself within a step, so it is held.
    const double rho = truth[Truth::kAirDensity];
    const auto rate = [&](double time, const State& x) {
      const double share = (time - t) / step_;
      const auto between = [share](double a, double b) { return a + share * (b - a); };
      Controls<double> c;
      c.de = between(now_.controls.de, next.controls.de);
      c.da = between(now_.controls.da, next.controls.da);
      c.dr = between(now_.controls.dr, next.controls.dr);
      c.throttle = between(now_.controls.throttle, next.controls.throttle);
      c.rotor_speed = between(now_.controls.rotor_speed, next.controls.rotor_speed);
      const Vector3d mean = now_.mean_wind + share * (next.mean_wind - now_.mean_wind);
      const Vector3d gust = now_.gust + share * (next.gust - now_.gust);
      return aircraft_rate<double>(subject_, body_, x, c, mean, gust, rho, gravity_,
                                   {.gust_rates = now_.gust_rates + share * (next.gust_rates - now_.gust_rates),
                                    .alpha = truth[Truth::kAlpha],
                                    .downwash_lag = now_.downwash_lag,
                                    .elapsed = time - t});
    };
    next.state = numerics::runge_kutta_4_step(rate, t, now_.state, step_);
    normalise_attitude(next.state);
    const UnsteadyAir<double> air{.alpha = truth[Truth::kAlpha], .downwash_lag = now_.downwash_lag, .elapsed = step_};
    next.downwash_lag = air.lag(subject_.downwash, air_data_at(next));
    now_ = next;
  }

 private:
  [[nodiscard]] Vector3d gust_vector() const {
    const std::array<double, 3> g = gusts_.gust();
    return {g[0], g[1], g[2]};
  }
  [[nodiscard]] Vector3d gust_rates() const {
    if (!with_gradients_) return Vector3d::Zero();
    const std::array<double, 3> g = gradients_.rates();
    return {g[0], g[1], g[2]};
  }

  [[nodiscard]] static AirData<double> air_data_at(const Moment& m) {
    return air_data<double>(R_body_from_ned(m.state) * (m.state.segment<3>(3) - m.mean_wind) - m.gust);
  }

  [[nodiscard]] PerSurface<double> within_stops(PerSurface<double> command) const {
    const PerSurface<const Actuator*> actuators{
        {&subject_.elevator, &subject_.aileron, &subject_.rudder, &subject_.throttle}};
    for (const Surface s : enumerators<Surface, kSurfaces>())
      command[s] = std::clamp(command[s], actuators[s]->lower, actuators[s]->upper);
    return command;
  }

  /// By how much of its distance to the steady speed a rotor comes nearer in a step.
  [[nodiscard]] static double rotor_share(const Propulsion& p, double step) {
    return p.kind == PropulsionKind::kPropeller && p.time_constant > 0.0 ? -std::expm1(-step / p.time_constant) : 1.0;
  }

  Subject subject_;
  MassProperties body_;
  double step_;
  double gravity_;
  double ground_;
  double rotor_share_;
  PerSurface<Servo> servos_;
  DrydenGusts gusts_;
  GustGradients gradients_;
  bool with_gradients_;
  Wind wind_;
  Moment now_;
};

/// Whether the flight ends at this moment, and why; kCompleted where it goes on.
FlightEnd end_of(const TruthSample& truth, double ground) {
  if (-truth[Truth::kPosDown] <= ground) return FlightEnd::kGround;
  const double p = truth[Truth::kGyroX], q = truth[Truth::kGyroY], r = truth[Truth::kGyroZ];
  const bool upset = std::abs(truth[Truth::kAlpha]) > 0.5 * kPi || Vector3d(p, q, r).norm() > 50.0;
  return upset ? FlightEnd::kUpset : FlightEnd::kCompleted;
}

/// Manoeuvres that began and changes that happened.
std::vector<Event> events_of(std::span<const Manoeuvre> manoeuvres, std::span<const ModelChange> changes, double end) {
  std::vector<Event> events;
  for (const Manoeuvre& m : manoeuvres) {
    if (m.start > end) continue;
    std::vector<std::string_view> names;
    for (const Surface surface : m.surfaces) names.push_back(kSurfaceNames[surface]);
    events.push_back({m.start, "manoeuvre", fmt::format("{} {}", name_of(m.kind), fmt::join(names, ", "))});
  }
  for (const ModelChange& change : changes) events.push_back({change.time, "change", change.text});
  return events;
}

}  // namespace

double default_airspeed(const Subject& s, double gravity) {
  return std::sqrt(2.0 * s.mass * gravity / (kSeaLevelDensity * s.wing_area * 0.5));
}

std::string SimulatedFlight::message() const {
  const auto at = [this] { return fmt::format("at {:.1f} s", end_time); };
  switch (end) {
    case FlightEnd::kCompleted:
      return fmt::format("flew {:.0f} s, angle of attack {:.1f} to {:.1f} deg", end_time, alpha_min / kDegree,
                         alpha_max / kDegree);
    case FlightEnd::kNoTrim:
      return trim.message();
    case FlightEnd::kGround:
      return fmt::format("the aircraft hit the ground {}", at());
    case FlightEnd::kUpset:
      return fmt::format("the aircraft departed from controlled flight {}", at());
    case FlightEnd::kDiverged:
      return fmt::format("the state is no longer finite {}: the step is too long for this aircraft", at());
    case FlightEnd::kInterrupted:
      return fmt::format("interrupted {}", at());
  }
  VERIDYN_ASSERT(false);
  return {};
}

SimulatedFlight simulate(const SimulationOptions& o, Progress& progress) {
  check(o);
  SimulatedFlight flight;
  flight.measured.source = flight.truth.source = fmt::format("simulated flight of {}", o.subject.name);
  flight.measured.frame = flight.truth.frame = Frame::kFrd;
  flight.trim =
      find_trim(o.subject, {.airspeed = o.airspeed > 0.0 ? o.airspeed : default_airspeed(o.subject, o.gravity),
                            .density = standard_atmosphere(o.altitude).density,
                            .bank = 0.0,
                            .gravity = o.gravity});
  if (!flight.trim.usable()) {
    flight.end = FlightEnd::kNoTrim;
    return flight;
  }
  const LinearModel linear = linearise(o.subject, flight.trim);
  flight.manoeuvres =
      o.manoeuvres ? *o.manoeuvres : default_plan(o.duration, default_amplitudes(o.subject, flight.trim, linear));
  const Excitation excitation(flight.manoeuvres);
  Autopilot pilot(o.subject, flight.trim, linear, o.altitude, o.heading, o.excitation_gain);
  FlyingAircraft aircraft(o, flight.trim);
  std::vector<Sensor> sensors;
  for (std::size_t i = 0; i < o.sensors.size(); ++i)
    sensors.emplace_back(o.log_commands ? of_commands(sensor_kinds()[i]) : sensor_kinds()[i], o.sensors[i], o.seed);

  TruthRecorder recorder;
  const auto steps = static_cast<long long>(std::llround(o.duration / o.step));
  const auto every = std::max(1LL, std::llround(1.0 / (o.truth_rate * o.step)));
  flight.alpha_min = kInfinity;
  flight.alpha_max = -flight.alpha_min;
  progress.stage(fmt::format("simulating {:.0f} s of flight", o.duration));
  std::size_t changed = 0;
  for (long long k = 0; k <= steps; ++k) {
    const double t = static_cast<double>(k) * o.step;
    while (changed < o.changes.size() && t >= o.changes[changed].time - 0.5 * o.step)
      aircraft.change_model(o.changes[changed++].model);
    const TruthSample truth = aircraft.truth();
    if (!aircraft.finite() || !std::isfinite(truth[Truth::kAirspeed])) {
      flight.end = FlightEnd::kDiverged;
      break;
    }
    for (Sensor& sensor : sensors) sensor.observe(t, truth);
    if (k % every == 0) recorder.add(t, truth);
    flight.end_time = t;
    flight.alpha_min = std::min(flight.alpha_min, truth[Truth::kAlpha]);
    flight.alpha_max = std::max(flight.alpha_max, truth[Truth::kAlpha]);
    flight.end = end_of(truth, o.ground);
    if (flight.end != FlightEnd::kCompleted) break;
    if (k % 2000 == 0 && !progress.update(static_cast<double>(k) / static_cast<double>(std::max(1LL, steps)))) {
      flight.end = FlightEnd::kInterrupted;
      break;
    }
    if (k < steps) aircraft.advance(t, truth, pilot.command(t, o.step, truth, excitation));
  }
  for (Sensor& sensor : sensors) sensor.move_into(flight.measured);
  if (o.lost_rows > 0.0) lose_rows(flight.measured, o.lost_rows, numerics::RandomStream(o.seed, "lost rows"));
  recorder.move_into(flight.truth, o);
  flight.measured.events = flight.truth.events =
      events_of(flight.manoeuvres, std::span(o.changes).first(changed), flight.end_time);
  static_cast<void>(progress.update(1.0));
  return flight;
}

}  // namespace veridyn::aircraft
