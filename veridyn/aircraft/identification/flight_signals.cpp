#include "veridyn/aircraft/identification/flight_signals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/nearest.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::aircraft {
namespace {

using numerics::FirKernel;
using recording::angle_on_grid;
using recording::on_grid;

constexpr double kDefaultPass_Hz = 10.0;

/// View of what flight signals are made from.
class Preparation {
 public:
  Preparation(const MappedRecording& mapped, const Recording& smoothed, const Subject& subject,
              const SignalOptions& options, const SensorSigma* known)
      : mapped_(mapped), smoothed_(smoothed), subject_(subject), options_(options), known_(known) {}

  FlightSignals run() {
    choose_grid();
    inertial();
    flow();
    inputs();
    thrust();
    context();
    return std::move(out_);
  }

 private:
  void choose_grid() {
    const std::vector<std::string> needed{"accel_x", "accel_y", "accel_z", "gyro_x", "gyro_y", "gyro_z"};
    require_channels(mapped_, needed, "the aerodynamic forces");
    const Channel& gyro = mapped_.recording.at("gyro_x");
    const double rate = recording::grid_rate(gyro, options_.rate_Hz);
    if (!(rate >= 10.0)) {
      throw InputError(
          mapped_.recording.source,
          fmt::format("its gyro is sampled at {:.1f} Hz; derivatives need at least 10 Hz", gyro.rate_Hz()));
    }
    out_.grid = recording::grid_over(gyro, rate, mapped_.recording.source);
    out_.filter.rate_Hz = rate;
    out_.filter.pass_Hz = options_.pass_Hz > 0.0 ? options_.pass_Hz : std::min(kDefaultPass_Hz, rate / 5.0);
    out_.filter.stop_Hz = std::min(1.5 * out_.filter.pass_Hz, 0.5 * rate);
    out_.filter.validate();
    smooth_ = numerics::low_pass(out_.filter);
    differentiate_ = numerics::low_pass_differentiator(out_.filter);
    out_.stride = std::max<std::size_t>(1, static_cast<std::size_t>(rate / (2.0 * out_.filter.stop_Hz)));
  }

  /// Standard deviation of the white noise of a channel, as the user says or as its content above the pass band shows.
  double noise_of(const std::string& name, const std::vector<double>& raw) const {
    if (const std::optional<double> given = recording::given_noise(options_.noise, name)) return *given;
    if (known_ != nullptr) {
      if (name.starts_with("gyro")) return known_->gyro;
      if (name.starts_with("accel")) return known_->accelerometer;
      if (name == "alpha") return known_->alpha;
      if (name == "beta") return known_->beta;
    }
    const double rate = out_.filter.rate_Hz;
    // A channel that is slower than the grid was interpolated: its noise is not white there and is measured as
    // recorded.
    const Channel& channel = mapped_.recording.at(name);
    return channel.rate_Hz() < 0.8 * rate ? recording::noise_floor(channel) : recording::noise_floor(raw, rate);
  }

  std::vector<double> linear_on_grid(const Channel& channel) const {
    return on_grid(channel, out_.grid, recording::Holes::kOfHalfASecond, numerics::Interpolation::kLinear);
  }

  void put(FlightSignal which, std::vector<double> value, double sigma, ErrorKind kind, std::string origin) {
    GridSignal& signal = out_[which];
    signal.value = std::move(value);
    signal.sigma = sigma;
    signal.error = kind;
    signal.origin = std::move(origin);
  }

  /// Noise that is left when white noise sampled at the channel's rate has passed the filter. A channel slower than
  /// the grid was interpolated, so that more of its noise lies in the pass band.
  double left_by(const FirKernel& kernel, const std::string& name, double sd) const {
    const double recorded = mapped_.recording.at(name).rate_Hz();
    const double per_grid_sample = std::max(1.0, out_.filter.rate_Hz / recorded);
    return sd * std::sqrt(kernel.noise_gain() * per_grid_sample);
  }

  void inertial() {
    const std::array<const char*, 3> gyros{"gyro_x", "gyro_y", "gyro_z"};
    const std::array<const char*, 3> accels{"accel_x", "accel_y", "accel_z"};
    const std::array<FlightSignal, 3> rates{FlightSignal::kP, FlightSignal::kQ, FlightSignal::kR};
    const std::array<FlightSignal, 3> derivatives{FlightSignal::kPdot, FlightSignal::kQdot, FlightSignal::kRdot};
    const std::array<FlightSignal, 3> forces{FlightSignal::kAx, FlightSignal::kAy, FlightSignal::kAz};
    for (std::size_t i = 0; i < 3; ++i) {
      const std::vector<double> raw = on_grid(mapped_.recording.at(gyros[i]), out_.grid);
      const double sd = noise_of(gyros[i], raw);
      put(rates[i], numerics::filter(raw, smooth_), left_by(smooth_, gyros[i], sd), ErrorKind::kClassical,
          "filtered gyro");
      put(derivatives[i], numerics::filter(raw, differentiate_), left_by(differentiate_, gyros[i], sd),
          ErrorKind::kClassical, "differentiated gyro");
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const std::vector<double> raw = on_grid(mapped_.recording.at(accels[i]), out_.grid);
      const double sd = noise_of(accels[i], raw);
      put(forces[i], numerics::filter(raw, smooth_), left_by(smooth_, accels[i], sd), ErrorKind::kClassical,
          "filtered accelerometer");
    }
    move_to_centre_of_gravity();
  }

  /// a_cg = a - w' x r - w x (w x r), r from the centre of gravity to the sensor.
  void move_to_centre_of_gravity() {
    const Eigen::Vector3d r(subject_.imu_position[0], subject_.imu_position[1], subject_.imu_position[2]);
    if (r.norm() == 0.0) return;
    for (std::size_t k = 0; k < out_.size(); ++k) {
      const auto at = [&](FlightSignal s) { return out_[s].value[k]; };
      const Eigen::Vector3d w(at(FlightSignal::kP), at(FlightSignal::kQ), at(FlightSignal::kR));
      const Eigen::Vector3d dw(at(FlightSignal::kPdot), at(FlightSignal::kQdot), at(FlightSignal::kRdot));
      const Eigen::Vector3d lever = dw.cross(r) + w.cross(w.cross(r));
      out_[FlightSignal::kAx].value[k] -= lever.x();
      out_[FlightSignal::kAy].value[k] -= lever.y();
      out_[FlightSignal::kAz].value[k] -= lever.z();
    }
    out_.notes.push_back(fmt::format("accelerometer moved by ({:.3f}, {:.3f}, {:.3f}) m to the centre of gravity",
                                     -r.x(), -r.y(), -r.z()));
  }

  /// Root mean square of a sigma channel: the typical error of the smoother.
  double typical_sigma(const char* name) const {
    const Channel* sigma = smoothed_.find(name);
    if (sigma == nullptr) return 0.0;
    double sum = 0.0;
    std::size_t count = 0;
    for (const double s : sigma->value) {
      if (!std::isfinite(s)) continue;
      sum += s * s;
      ++count;
    }
    return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0.0;
  }

  void flow() {
    put(FlightSignal::kAirspeed, on_grid(smoothed_.at("airspeed"), out_.grid), typical_sigma("sigma_airspeed"),
        ErrorKind::kBerkson, "smoother");
    out_.alpha_smoothed = on_grid(smoothed_.at("alpha"), out_.grid);
    out_.beta_smoothed = on_grid(smoothed_.at("beta"), out_.grid);
    flow_angle(FlightSignal::kAlpha, "alpha", out_.alpha_smoothed);
    flow_angle(FlightSignal::kBeta, "beta", out_.beta_smoothed);
  }

  void flow_angle(FlightSignal which, const char* name, const std::vector<double>& smoothed) {
    const Channel* vane = mapped_.recording.find(name);
    if (options_.flow_angles == FlowAngles::kVane && vane == nullptr) {
      throw InputError(mapped_.recording.source,
                       fmt::format("has no {} vane, which signals.flow_angles = \"vane\" asks for", name));
    }
    if (vane == nullptr || options_.flow_angles == FlowAngles::kSmoothed) {
      // The smoother follows what the filter cannot: the same pass band for all regressors.
      put(which, numerics::filter(smoothed, smooth_), typical_sigma(fmt::format("sigma_{}", name).c_str()),
          ErrorKind::kBerkson, "smoother");
      return;
    }
    std::vector<double> raw = on_grid(*vane, out_.grid);
    const double sd = noise_of(name, raw);
    std::vector<double> value = numerics::filter(raw, smooth_);
    // The smoother may have found a bias of the vane: the mean difference where both are there.
    const Channel* bias = smoothed_.find(fmt::format("{}_bias", name));
    if (bias != nullptr && !bias->empty()) {
      const double b = numerics::median(bias->value);
      for (double& v : value) v -= b;
      out_.notes.push_back(fmt::format("{} vane: estimated bias of {:.2f} deg taken off", name, b * 180.0 / kPi));
    }
    put(which, std::move(value), left_by(smooth_, name, sd), ErrorKind::kClassical, "filtered vane");
  }

  void inputs() {
    const std::array<std::pair<const char*, FlightSignal>, 3> surfaces{{{"elevator", FlightSignal::kElevator},
                                                                        {"aileron", FlightSignal::kAileron},
                                                                        {"rudder", FlightSignal::kRudder}}};
    for (const auto& [name, which] : surfaces) {
      const Channel* channel = mapped_.recording.find(name);
      if (channel == nullptr) continue;
      // Positions of servos are what was commanded or read back: known, but for the delay that was taken off before.
      const std::vector<double> position = linear_on_grid(*channel);
      if (channel->rate_Hz() > 0.8 * out_.filter.rate_Hz) find_jumps(position, which);
      put(which, numerics::filter(position, smooth_), 0.0, ErrorKind::kExact, "filtered position");
    }
    const std::vector<double>& taps = smooth_.taps;
    out_.jump_response.assign(taps.size() + 1, 0.0);
    for (std::size_t i = 0; i < taps.size(); ++i) {
      out_.jump_response[i] += 0.5 * taps[i];
      out_.jump_response[i + 1] += 0.5 * taps[i];
    }
  }

  /// Changes within one sample by a good part of the throw, with little change before and after. A servo with a lag of
  /// two samples or more shows none.
  void find_jumps(const std::vector<double>& position, FlightSignal control) {
    constexpr double kOfThrow = 0.05;
    constexpr double kNeighbours = 0.3;
    double low = kInfinity, high = -kInfinity;
    for (const double v : position) {
      if (!std::isfinite(v)) continue;
      low = std::min(low, v);
      high = std::max(high, v);
    }
    for (std::size_t k = 2; k + 1 < position.size(); ++k) {
      const double change = std::abs(position[k] - position[k - 1]);
      if (!(change > kOfThrow * (high - low))) continue;
      const double beside =
          std::max(std::abs(position[k - 1] - position[k - 2]), std::abs(position[k + 1] - position[k]));
      if (beside < kNeighbours * change) out_.jumps.push_back({control, k});
    }
  }

  void thrust() {
    const Channel* rho = smoothed_.find("air_density");
    out_.air_density = rho != nullptr ? linear_on_grid(*rho) : std::vector<double>(out_.size(), 1.225);
    double last = 1.225;
    for (double& density : out_.air_density) {
      if (!std::isfinite(density)) density = last;
      last = density;
    }
    if (const Channel* channel = mapped_.recording.find("thrust")) {
      put(FlightSignal::kThrust, numerics::filter(on_grid(*channel, out_.grid), smooth_), 0.0, ErrorKind::kExact,
          "recorded");
      return;
    }
    const Channel* throttle = mapped_.recording.find("throttle");
    if (subject_.propulsion.kind == PropulsionKind::kNone || throttle == nullptr) {
      out_.notes.emplace_back(throttle == nullptr ? "thrust is unknown: the log has neither thrust nor throttle"
                                                  : "thrust is unknown: the subject has no propulsion model");
      return;
    }
    const std::vector<double> command = linear_on_grid(*throttle);
    const std::vector<double>& airspeed = out_[FlightSignal::kAirspeed].value;
    std::vector<double> force(out_.size(), kNaN);
    out_.torque.assign(out_.size(), 0.0);
    out_.thrust_per_airspeed.assign(out_.size(), 0.0);
    constexpr double kStep_mps = 0.01;
    double rotor = kNaN;
    for (std::size_t k = 0; k < out_.size(); ++k) {
      if (!std::isfinite(command[k]) || !std::isfinite(airspeed[k])) continue;
      const double steady = subject_.propulsion.steady_rotor_speed(command[k]);
      const bool lags = subject_.propulsion.kind == PropulsionKind::kPropeller && std::isfinite(rotor);
      rotor = lags ? steady + (rotor - steady) * std::exp(-out_.grid.step / subject_.propulsion.time_constant) : steady;
      // The propeller sees the airspeed along its axis.
      const double along = std::cos(out_.alpha_smoothed[k]) * std::cos(out_.beta_smoothed[k]);
      const auto load_at = [&](double Va) {
        return subject_.propulsion.load(command[k], Va * along, out_.air_density[k], rotor);
      };
      const auto load = load_at(airspeed[k]);
      force[k] = load.thrust;
      out_.torque[k] = load.torque;
      out_.thrust_per_airspeed[k] =
          (load_at(airspeed[k] + kStep_mps).thrust - load_at(airspeed[k] - kStep_mps).thrust) / (2.0 * kStep_mps);
    }
    put(FlightSignal::kThrust, std::move(force), 0.0, ErrorKind::kExact, "propulsion model");
  }

  void context() {
    const auto take = [&](const char* name) {
      const Channel* channel = smoothed_.find(name);
      return channel == nullptr ? std::vector<double>(out_.size(), kNaN) : on_grid(*channel, out_.grid);
    };
    out_.roll = angle_on_grid(smoothed_.at("roll"), out_.grid);
    out_.pitch = angle_on_grid(smoothed_.at("pitch"), out_.grid);
    out_.yaw = angle_on_grid(smoothed_.at("yaw"), out_.grid);
    out_.vel_north = take("vel_north");
    out_.vel_east = take("vel_east");
    out_.vel_down = take("vel_down");
    out_.wind_north = take("wind_north");
    out_.wind_east = take("wind_east");
    out_.wind_down = take("wind_down");
  }

  const MappedRecording& mapped_;
  const Recording& smoothed_;
  const Subject& subject_;
  const SignalOptions& options_;
  const SensorSigma* known_;
  FirKernel smooth_;
  FirKernel differentiate_;
  FlightSignals out_;
};

}  // namespace

SignalOptions SignalOptions::read(const StudyTable& table) {
  SignalOptions options;
  options.rate_Hz = table.has("rate") ? table.positive("rate", "Hz") : 0.0;
  options.pass_Hz = table.has("pass_band") ? table.positive("pass_band", "Hz") : 0.0;
  const std::vector<std::string> choices{"auto", "vane", "smoothed"};
  const std::string angles = table.choice_or("flow_angles", choices, "auto");
  options.flow_angles = angles == "vane"       ? FlowAngles::kVane
                        : angles == "smoothed" ? FlowAngles::kSmoothed
                                               : FlowAngles::kAuto;
  options.noise = recording::read_noise(table.table_or_empty("noise"), standard_channels());
  return options;
}

FlightSample<double> FlightSignals::sample(std::size_t k) const {
  FlightSample<double> s;
  for (std::size_t i = 0; i < kFlightSignals; ++i) s.value[i] = signals[i].available() ? signals[i].value[k] : 0.0;
  return s;
}

FlightSignals prepare_signals(const MappedRecording& mapped, const Recording& smoothed, const Subject& subject,
                              const SignalOptions& options, const SensorSigma* known) {
  return Preparation(mapped, smoothed, subject, options, known).run();
}

}  // namespace veridyn::aircraft
