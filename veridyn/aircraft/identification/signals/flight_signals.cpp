#include "veridyn/aircraft/identification/signals/flight_signals.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <utility>

#include "veridyn/aircraft/model/atmosphere.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/core/study_keys.hpp"
#include "veridyn/numerics/rotation.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/numerics/threads/parallel.hpp"

namespace veridyn::aircraft {
namespace {

using numerics::FirKernel;
using recording::angle_on_grid;
using recording::on_grid;

constexpr double kDefaultPass_Hz = 10.0;

/// The grid of a flight and the filters that all of its signals go through.
struct CommonGrid {
  numerics::UniformGrid grid;
  numerics::LowPassDesign filter;
  FirKernel smooth, differentiate;
  std::size_t stride = 1;
};

CommonGrid common_grid(const MappedRecording& mapped, const SignalOptions& options) {
  const std::vector<std::string> needed{"gyro_x", "gyro_y", "gyro_z"};
  require_channels(mapped, needed, "the aerodynamic coefficients");
  const Channel& gyro = mapped.recording.at("gyro_x");
  const double rate = recording::grid_rate(gyro, options.rate_Hz);
  if (!(rate >= 10.0)) {
    throw InputError(mapped.recording.source,
                     fmt::format("its gyro is sampled at {:.1f} Hz; derivatives need at least 10 Hz", gyro.rate_Hz()));
  }
  numerics::LowPassDesign filter;
  filter.rate_Hz = rate;
  filter.pass_Hz = options.pass_Hz > 0.0 ? options.pass_Hz : std::min(kDefaultPass_Hz, rate / 5.0);
  filter.stop_Hz = std::min(1.5 * filter.pass_Hz, 0.5 * rate);
  filter.validate();
  return {.grid = recording::grid_over(gyro, rate, mapped.recording.source),
          .filter = filter,
          .smooth = numerics::low_pass(filter),
          .differentiate = numerics::low_pass_differentiator(filter),
          .stride = std::max<std::size_t>(1, static_cast<std::size_t>(rate / (2.0 * filter.stop_Hz)))};
}

/// View of a recording's channels as they come onto a grid and through its filters, and of what is known of their
/// noise.
class GriddedChannels {
 public:
  GriddedChannels(const MappedRecording& mapped, const CommonGrid& common, const SignalOptions& options,
                  const SensorSigma* known)
      : mapped_(mapped), common_(common), options_(options), known_(known) {}

  [[nodiscard]] const Channel* find(std::string_view name) const { return mapped_.recording.find(name); }
  [[nodiscard]] const std::string& source() const { return mapped_.recording.source; }
  [[nodiscard]] std::vector<double> raw(const std::string& name) const {
    return on_grid(mapped_.recording.at(name), common_.grid);
  }

  /// Standard deviation of the white noise of a channel, as the user says or as its content above the pass band shows.
  [[nodiscard]] double noise_of(const std::string& name) const {
    if (const std::optional<double> given = recording::given_noise(options_.noise, name)) return *given;
    if (known_ != nullptr) {
      if (name.starts_with("gyro")) return known_->gyro;
      if (name.starts_with("accel")) return known_->accelerometer;
      if (name == "alpha") return known_->alpha;
      if (name == "beta") return known_->beta;
    }
    return recording::noise_floor(mapped_.recording.at(name));
  }

  /// A measured channel of white noise `sd` through a filter.
  [[nodiscard]] GridSignal filtered(const FirKernel& kernel, const std::string& name, const std::vector<double>& raw,
                                    double sd, std::string origin) const {
    return {.value = numerics::filter(raw, kernel),
            .sigma = left_by(kernel, name, sd),
            .error = ErrorKind::kClassical,
            .origin = std::move(origin)};
  }

 private:
  /// Noise that is left when white noise sampled at the channel's rate has passed the filter. A channel slower than
  /// the grid was interpolated, so that more of its noise lies in the pass band; likewise where rows are lost.
  [[nodiscard]] double left_by(const FirKernel& kernel, const std::string& name, double sd) const {
    const Channel& channel = mapped_.recording.at(name);
    double holes = 0.0;
    for (const TimeSpan& hole : channel.gaps(0.5)) holes += hole.duration();
    const double recorded = std::min(
        channel.rate_Hz(), static_cast<double>(channel.size()) / std::max(channel.span().duration() - holes, 1e-3));
    const double per_grid_sample = std::max(1.0, common_.filter.rate_Hz / recorded);
    return sd * std::sqrt(kernel.noise_gain() * per_grid_sample);
  }

  const MappedRecording& mapped_;
  const CommonGrid& common_;
  const SignalOptions& options_;
  const SensorSigma* known_;
};

/// A control or a force that is known but for its delay.
GridSignal exact(std::vector<double> value, std::string origin) {
  return {.value = std::move(value), .sigma = 0.0, .error = ErrorKind::kExact, .origin = std::move(origin)};
}

std::vector<double> linear_on_grid(const Channel& channel, const numerics::UniformGrid& grid) {
  return on_grid(channel, grid, recording::Holes::kOfHalfASecond, numerics::Interpolation::kLinear);
}

/// Rates, their derivatives and specific forces, about x, y and z.
struct InertialSignals {
  std::array<GridSignal, 3> rate, rate_derivative, force;
};

/// Those of one axis, 0 to 2.
void find_inertial(const GriddedChannels& channels, const CommonGrid& common, std::size_t axis,
                   InertialSignals& signals) {
  static constexpr std::array<const char*, 3> kGyros{"gyro_x", "gyro_y", "gyro_z"};
  static constexpr std::array<const char*, 3> kAccelerometers{"accel_x", "accel_y", "accel_z"};
  const char* const gyro = kGyros[axis];
  const std::vector<double> rate = channels.raw(gyro);
  const double gyro_sd = channels.noise_of(gyro);
  signals.rate[axis] = channels.filtered(common.smooth, gyro, rate, gyro_sd, "filtered gyro");
  signals.rate_derivative[axis] = channels.filtered(common.differentiate, gyro, rate, gyro_sd, "differentiated gyro");
  const char* const accelerometer = kAccelerometers[axis];
  if (channels.find(accelerometer) == nullptr) return;
  const std::vector<double> force = channels.raw(accelerometer);
  signals.force[axis] = channels.filtered(common.smooth, accelerometer, force, channels.noise_of(accelerometer),
                                          "filtered accelerometer");
}

/// Specific force at the centre of gravity: a_cg = a - w' x r - w x (w x r), `r` from there to the sensor [m].
std::array<GridSignal, 3> force_at_centre_of_gravity(const InertialSignals& at_sensor, const Eigen::Vector3d& r) {
  std::array<GridSignal, 3> force = at_sensor.force;
  if (!std::ranges::all_of(force, &GridSignal::available)) return force;
  for (std::size_t k = 0; k < force[0].value.size(); ++k) {
    const auto at = [k](const std::array<GridSignal, 3>& s) {
      return Eigen::Vector3d(s[0].value[k], s[1].value[k], s[2].value[k]);
    };
    const Eigen::Vector3d w = at(at_sensor.rate), dw = at(at_sensor.rate_derivative);
    const Eigen::Vector3d lever = dw.cross(r) + w.cross(w.cross(r));
    for (std::size_t i = 0; i < 3; ++i) force[i].value[k] -= lever(i);
  }
  // With the noise of the angular accelerations that it was moved by; that of the rates is small beside it.
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Eigen::Index j = (i + 1) % 3, l = (i + 2) % 3;
    const double by_j = at_sensor.rate_derivative[at(j)].sigma * r(l);
    const double by_l = at_sensor.rate_derivative[at(l)].sigma * r(j);
    force[at(i)].sigma = std::hypot(force[at(i)].sigma, by_j, by_l);
  }
  return force;
}

/// Root mean square of a sigma channel: the typical error of the smoother.
double typical_sigma(const Recording& smoothed, const std::string& name) {
  const Channel* sigma = smoothed.find(name);
  if (sigma == nullptr) return 0.0;
  return numerics::rms(sigma->value);
}

/// @param smoothed_angle the smoother's, on the grid; empty where there is none
GridSignal flow_angle(const GriddedChannels& channels, const CommonGrid& common, const Recording& smoothed,
                      FlowAngles choice, const std::string& name, const std::vector<double>& smoothed_angle) {
  const Channel* vane = channels.find(name);
  if (choice == FlowAngles::kVane && vane == nullptr) {
    throw InputError(channels.source(),
                     fmt::format("has no {} vane, which signals.flow_angles = \"vane\" asks for", name));
  }
  if (vane == nullptr && smoothed_angle.empty()) return {};
  if (vane == nullptr || (choice == FlowAngles::kSmoothed && !smoothed_angle.empty())) {
    // The smoother follows what the filter cannot: the same pass band for all regressors.
    return {.value = numerics::filter(smoothed_angle, common.smooth),
            .sigma = typical_sigma(smoothed, "sigma_" + name),
            .error = ErrorKind::kBerkson,
            .origin = "smoother"};
  }
  const std::vector<double> raw = channels.raw(name);
  return channels.filtered(common.smooth, name, raw, channels.noise_of(name), "filtered vane");
}

/// Air density on the grid [kg/m^3]; where it is missing the last known one.
std::vector<double> air_density_on(const Recording& smoothed, const numerics::UniformGrid& grid) {
  const Channel* rho = smoothed.find("air_density");
  if (rho == nullptr) return std::vector<double>(grid.count, kSeaLevelDensity);
  std::vector<double> density = linear_on_grid(*rho, grid);
  double last = kSeaLevelDensity;
  for (double& d : density) {
    if (!std::isfinite(d)) d = last;
    last = d;
  }
  return density;
}

/// Motion through the air.
struct FlowSignals {
  GridSignal airspeed, alpha, beta;
  std::vector<double> alpha_smoothed, beta_smoothed;  ///< the smoother's, whatever is regressed on
  std::vector<double> air_density;                    ///< [kg/m^3]
};

FlowSignals flow_signals(const GriddedChannels& channels, const CommonGrid& common, const Recording& smoothed,
                         FlowAngles choice) {
  const bool recorded = smoothed.information.contains("airspeed");
  const auto estimated = [&](const char* name) {
    const Channel* channel = smoothed.find(name);
    return channel == nullptr ? std::vector<double>() : on_grid(*channel, common.grid);
  };
  std::vector<double> alpha_smoothed = estimated("alpha");
  std::vector<double> beta_smoothed = estimated("beta");
  GridSignal alpha = flow_angle(channels, common, smoothed, choice, "alpha", alpha_smoothed);
  GridSignal beta = flow_angle(channels, common, smoothed, choice, "beta", beta_smoothed);
  for (std::vector<double>* angle : {&alpha_smoothed, &beta_smoothed})
    if (angle->empty()) angle->assign(common.grid.count, kNaN);
  return {.airspeed = {.value = on_grid(smoothed.at("airspeed"), common.grid),
                       .sigma = typical_sigma(smoothed, "sigma_airspeed"),
                       .error = recorded ? ErrorKind::kClassical : ErrorKind::kBerkson,
                       .origin = recorded ? "filtered airspeed" : "smoother"},
          .alpha = std::move(alpha),
          .beta = std::move(beta),
          .alpha_smoothed = std::move(alpha_smoothed),
          .beta_smoothed = std::move(beta_smoothed),
          .air_density = air_density_on(smoothed, common.grid)};
}

/// Changes within one sample by a good part of the throw, with little change before and after. A servo with a lag of
/// two samples or more shows none.
std::vector<DeflectionJump> jumps_of(std::span<const double> position, FlightSignal control) {
  constexpr double kOfThrow = 0.05;
  constexpr double kNeighbours = 0.3;
  double low = kInfinity, high = -kInfinity;
  for (const double v : position) {
    if (!std::isfinite(v)) continue;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  std::vector<DeflectionJump> jumps;
  for (std::size_t k = 2; k + 1 < position.size(); ++k) {
    const double change = std::abs(position[k] - position[k - 1]);
    if (!(change > kOfThrow * (high - low))) continue;
    const double neighbouring =
        std::max(std::abs(position[k - 1] - position[k - 2]), std::abs(position[k + 1] - position[k]));
    if (neighbouring < kNeighbours * change) jumps.push_back({control, k});
  }
  return jumps;
}

/// What an impulse midway between two samples becomes.
std::vector<double> response_to_jump(const FirKernel& kernel) {
  std::vector<double> response(kernel.taps.size() + 1, 0.0);
  for (std::size_t i = 0; i < kernel.taps.size(); ++i) {
    response[i] += 0.5 * kernel.taps[i];
    response[i + 1] += 0.5 * kernel.taps[i];
  }
  return response;
}

/// Position of a surface and where it jumps.
struct Deflection {
  GridSignal signal;  ///< not available where it is not recorded
  std::vector<DeflectionJump> jumps;
};

Deflection deflection(const GriddedChannels& channels, const CommonGrid& common, const char* name, FlightSignal which) {
  const Channel* channel = channels.find(name);
  if (channel == nullptr) return {};
  // Positions of servos are what was commanded or read back: known, but for the delay that was taken off before.
  const std::vector<double> position = linear_on_grid(*channel, common.grid);
  const bool fast = channel->rate_Hz() > 0.8 * common.filter.rate_Hz;
  return {.signal = exact(numerics::filter(position, common.smooth), "filtered position"),
          .jumps = fast ? jumps_of(position, which) : std::vector<DeflectionJump>{}};
}

/// Thrust along a flight and what comes with it where it is computed.
struct ThrustSignals {
  GridSignal thrust;
  std::vector<double> torque, per_airspeed;  ///< see FlightSignals
  std::string note;                          ///< why there is none
};

/// Thrust of the subject's propulsion under the recorded throttle.
/// @param command on a grid of `step` [s], as `flow`
ThrustSignals computed_thrust(const Propulsion& propulsion, const std::vector<double>& command, double step,
                              const FlowSignals& flow) {
  const std::vector<double>& airspeed = flow.airspeed.value;
  std::vector<double> force(command.size(), kNaN), torque(command.size(), 0.0), per_airspeed(command.size(), 0.0);
  constexpr double kStep_mps = 0.01;
  double rotor = kNaN;
  const auto cosine = [](double angle) { return std::isfinite(angle) ? std::cos(angle) : 1.0; };
  for (std::size_t k = 0; k < command.size(); ++k) {
    if (!std::isfinite(command[k]) || !std::isfinite(airspeed[k])) continue;
    const double steady = propulsion.steady_rotor_speed(command[k]);
    const bool lags = propulsion.kind == PropulsionKind::kPropeller && std::isfinite(rotor);
    rotor = lags ? steady + (rotor - steady) * std::exp(-step / propulsion.time_constant) : steady;
    // The propeller sees the airspeed along its axis.
    const double along = cosine(flow.alpha_smoothed[k]) * cosine(flow.beta_smoothed[k]);
    const auto load_at = [&](double Va) { return propulsion.load(command[k], Va * along, flow.air_density[k], rotor); };
    const auto load = load_at(airspeed[k]);
    force[k] = load.thrust;
    torque[k] = load.torque;
    per_airspeed[k] =
        (load_at(airspeed[k] + kStep_mps).thrust - load_at(airspeed[k] - kStep_mps).thrust) / (2.0 * kStep_mps);
  }
  return {.thrust = exact(std::move(force), "propulsion model"),
          .torque = std::move(torque),
          .per_airspeed = std::move(per_airspeed),
          .note = {}};
}

/// The channel `thrust`, or with `throttle` the subject's propulsion.
ThrustSignals thrust_signals(const GriddedChannels& channels, const CommonGrid& common, const Propulsion& propulsion,
                             const FlowSignals& flow) {
  if (channels.find("thrust") != nullptr) {
    return {.thrust = exact(numerics::filter(channels.raw("thrust"), common.smooth), "recorded"),
            .torque = {},
            .per_airspeed = {},
            .note = {}};
  }
  const Channel* throttle = channels.find("throttle");
  if (propulsion.kind != PropulsionKind::kNone && throttle != nullptr)
    return computed_thrust(propulsion, linear_on_grid(*throttle, common.grid), common.grid.step, flow);
  return {.thrust = {},
          .torque = {},
          .per_airspeed = {},
          .note = throttle == nullptr ? "thrust is unknown: the log has neither thrust nor throttle"
                                      : "thrust is unknown: the subject has no propulsion model"};
}

/// What stands for the ground velocity where there is none: R (v_r + gust), north where the heading counts from.
void velocity_through_mean_air(const Recording& smoothed, FlightSignals& flight) {
  std::array<std::vector<double>, 3> v;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string axis(1, "xyz"[i]);
    v[i] = on_grid(smoothed.at("air_velocity_" + axis), flight.grid);
    const std::vector<double> gust = on_grid(smoothed.at("gust_" + axis), flight.grid);
    for (std::size_t k = 0; k < v[i].size(); ++k) v[i][k] += gust[k];
  }
  for (std::size_t k = 0; k < flight.grid.count; ++k) {
    const Eigen::Vector3d ned = numerics::R_body_from_ned(flight.roll[k], flight.pitch[k], flight.yaw[k]).transpose() *
                                Eigen::Vector3d(v[0][k], v[1][k], v[2][k]);
    for (std::size_t i = 0; i < 3; ++i) v[i][k] = ned(i);
  }
  flight.vel_north = std::move(v[0]);
  flight.vel_east = std::move(v[1]);
  flight.vel_down = std::move(v[2]);
}

}  // namespace

const KeyTable<SignalOptions>& SignalOptions::keys() {
  using O = SignalOptions;
  static const auto table =
      KeyTable<O>("signals", "How recorded channels become signals on one grid.")
          .number("rate", &O::rate_Hz, "Hz", kPositive, "of the common grid; at least 10")
          .otherwise("the gyro's, at most 100; of several flights that of the slowest")
          .number("pass_band", &O::pass_Hz, "Hz", kPositive, "frequencies up to here are kept unchanged")
          .otherwise("10, or a fifth of the rate where that is less")
          .choice("flow_angles", &O::flow_angles,
                  {{"auto", FlowAngles::kAuto}, {"vane", FlowAngles::kVane}, {"smoothed", FlowAngles::kSmoothed}},
                  "what coefficients are regressed on: the filtered vane or the smoother's angle; `auto`: a vane where "
                  "there is one")
          .other(recording::noise_key("measured above the pass band"),
                 [](const StudyTable& t, const std::string& key, O& o) {
                   o.noise = recording::read_noise(t.table(key), standard_channels());
                 });
  return table;
}

FlightSample<double> FlightSignals::sample(std::size_t k) const {
  FlightSample<double> s;
  for (std::size_t i = 0; i < kFlightSignals; ++i) s.value[i] = signals[i].available() ? signals[i].value[k] : 0.0;
  return s;
}

FlightSignals prepare_signals(const MappedRecording& mapped, const Recording& smoothed, const FlowSensors& vanes,
                              const Subject& subject, const SignalOptions& options, const SensorSigma* known,
                              int threads) {
  const CommonGrid common = common_grid(mapped, options);
  // A recording of an hour is not copied where nothing is corrected.
  CorrectedFlow corrected;
  if (!vanes.exact()) corrected = with_corrected_flow(mapped, vanes, smoothed);
  const GriddedChannels channels(vanes.exact() ? mapped : corrected.mapped, common, options, known);
  const numerics::UniformGrid& grid = common.grid;
  FlightSignals flight;
  flight.grid = grid;
  flight.filter = common.filter;
  flight.stride = common.stride;
  const auto note = [&flight](std::string text) {
    if (!text.empty()) flight.notes.push_back(std::move(text));
  };

  using F = FlightSignal;
  static constexpr std::array<std::pair<const char*, F>, 3> kSurfaces{
      {{"elevator", F::kElevator}, {"aileron", F::kAileron}, {"rudder", F::kRudder}}};
  const auto angle_where_known = [&](const char* name, double otherwise) {
    const Channel* channel = smoothed.find(name);
    return channel == nullptr ? std::vector<double>(grid.count, otherwise) : angle_on_grid(*channel, grid);
  };
  const auto where_known = [&](const char* name) {
    const Channel* channel = smoothed.find(name);
    return channel == nullptr ? std::vector<double>(grid.count, kNaN) : on_grid(*channel, grid);
  };
  InertialSignals inertial;
  FlowSignals flow;
  std::array<Deflection, 3> surfaces;
  std::vector<std::function<void()>> parts{
      [&] { flow = flow_signals(channels, common, smoothed, options.flow_angles); },
      [&] { flight.roll = angle_where_known("roll", kNaN); },
      [&] { flight.pitch = angle_where_known("pitch", kNaN); },
      [&] { flight.yaw = angle_where_known("yaw", 0.0); },  // where nothing shows the heading, any does
      [&] { flight.vel_north = where_known("vel_north"); },
      [&] { flight.vel_east = where_known("vel_east"); },
      [&] { flight.vel_down = where_known("vel_down"); },
      [&] { flight.wind_north = where_known("wind_north"); },
      [&] { flight.wind_east = where_known("wind_east"); },
      [&] { flight.wind_down = where_known("wind_down"); }};
  for (std::size_t i = 0; i < 3; ++i) {
    parts.emplace_back([&, i] { find_inertial(channels, common, i, inertial); });
    parts.emplace_back([&, i] { surfaces[i] = deflection(channels, common, kSurfaces[i].first, kSurfaces[i].second); });
  }
  numerics::parallel_for(parts.size(), threads, [&](std::size_t i) { parts[i](); });

  const Eigen::Vector3d arm(subject.imu_position[0], subject.imu_position[1], subject.imu_position[2]);
  if (arm.norm() > 0.0) {
    inertial.force = force_at_centre_of_gravity(inertial, arm);
    note(fmt::format("accelerometer moved by ({:.3f}, {:.3f}, {:.3f}) m to the centre of gravity", -arm.x(), -arm.y(),
                     -arm.z()));
  }
  const std::array<F, 3> rates{F::kP, F::kQ, F::kR}, derivatives{F::kPdot, F::kQdot, F::kRdot},
      forces{F::kAx, F::kAy, F::kAz};
  for (std::size_t i = 0; i < 3; ++i) {
    flight[rates[i]] = std::move(inertial.rate[i]);
    flight[derivatives[i]] = std::move(inertial.rate_derivative[i]);
    flight[forces[i]] = std::move(inertial.force[i]);
  }

  ThrustSignals thrust = thrust_signals(channels, common, subject.propulsion, flow);
  note(corrected.note);
  note(std::move(thrust.note));
  flight[F::kAirspeed] = std::move(flow.airspeed);
  flight[F::kAlpha] = std::move(flow.alpha);
  flight[F::kBeta] = std::move(flow.beta);
  flight.alpha_smoothed = std::move(flow.alpha_smoothed);
  flight.beta_smoothed = std::move(flow.beta_smoothed);
  flight.air_density = std::move(flow.air_density);
  flight[F::kThrust] = std::move(thrust.thrust);
  flight.torque = std::move(thrust.torque);
  flight.thrust_per_airspeed = std::move(thrust.per_airspeed);

  for (std::size_t i = 0; i < 3; ++i) {
    flight[kSurfaces[i].second] = std::move(surfaces[i].signal);
    flight.jumps.insert(flight.jumps.end(), surfaces[i].jumps.begin(), surfaces[i].jumps.end());
  }
  flight.jump_response = response_to_jump(common.smooth);

  flight.roll_sigma = typical_sigma(smoothed, "sigma_roll");
  flight.pitch_sigma = typical_sigma(smoothed, "sigma_pitch");
  flight.over_ground = smoothed.has("vel_north");
  flight.air_rates = air_rates(smoothed, grid, flight[F::kAirspeed].value, common.smooth, subject);
  if (!flight.over_ground && smoothed.has("gust_x")) velocity_through_mean_air(smoothed, flight);
  return flight;
}

}  // namespace veridyn::aircraft
