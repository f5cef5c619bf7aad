#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "veridyn/aircraft/air_data_filter.hpp"
#include "veridyn/aircraft/reconstruct_streams.hpp"
#include "veridyn/estimation/kalman_filter.hpp"
#include "veridyn/numerics/rotation.hpp"

/// Inside of reconstruct.cpp: the filter going through one segment, event by event.
namespace veridyn::aircraft::internal {

/// What does not change along a run.
template <class Model>
struct RunSetting {
  const FlightStreams* streams;
  const ReconstructOptions* options;
  Model model;
  const std::vector<double>* output_t;  ///< stamps of results over all segments
};

/// The state at the first output of a segment, before any measurement but those that start it.
template <class Model>
struct Start {
  typename Model::template State<double> x;
  typename Model::Covariance P;
};

/// Median of the samples in [from, from + window]; NaN when there are none.
inline double median_within(const Stream& s, double from, double window) {
  const auto first = std::lower_bound(s.t.begin(), s.t.end(), from);
  const auto last = std::upper_bound(first, s.t.end(), from + window);
  if (first == last) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> v(s.v.begin() + (first - s.t.begin()), s.v.begin() + (last - s.t.begin()));
  std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
  return v[v.size() / 2];
}

template <class Model>
[[nodiscard]] Start<Model> start_of(const RunSetting<Model>& setting, const Segment& segment) {
  const FlightStreams& s = *setting.streams;
  const ReconstructOptions& o = *setting.options;
  const auto first = [&](Sensor which) {
    const Stream& stream = s.sensors[which];
    const auto it = std::upper_bound(stream.t.begin(), stream.t.end(), segment.begin);
    return stream.v[static_cast<std::size_t>(std::max<std::ptrdiff_t>(it - stream.t.begin() - 1, 0))];
  };
  Start<Model> start;
  auto& x = start.x;
  x.attitude = numerics::quaternion_from_euler(first(kRoll), first(kPitch), first(kYaw));
  x.velocity = Eigen::Vector3d(first(kVelNorth), first(kVelEast), first(kVelDown));

  // u_r = R v_ground scaled to |v_r| = Va, unless vanes say where the air comes from.
  constexpr double kWindow = 1.0;
  double airspeed = median_within(s.sensors[kPitot], segment.begin, kWindow);
  if (std::isfinite(airspeed) && s.pitot_is_pressure) {
    std::size_t cursor = 0;
    airspeed = std::sqrt(2.0 * std::max(airspeed, 0.0) / s.density_at(segment.begin, cursor));
  }
  const double alpha = median_within(s.sensors[kAlpha], segment.begin, kWindow);
  const double beta = median_within(s.sensors[kBeta], segment.begin, kWindow);
  const Eigen::Vector3d ground = x.attitude.conjugate() * x.velocity;
  if (!std::isfinite(airspeed)) airspeed = ground.norm();
  Eigen::Vector3d direction = ground.norm() > 1.0 ? Eigen::Vector3d(ground.normalized()) : Eigen::Vector3d::UnitX();
  if (std::isfinite(alpha) || std::isfinite(beta)) {
    const double a = std::isfinite(alpha) ? std::clamp(alpha, -0.5, 0.5) : 0.0;
    const double b = std::isfinite(beta) ? std::clamp(beta, -0.5, 0.5) : 0.0;
    direction = Eigen::Vector3d(std::cos(a) * std::cos(b), std::sin(b), std::sin(a) * std::cos(b));
  }
  x.wind = x.velocity - x.attitude * Eigen::Vector3d(direction * airspeed);
  x.wind.z() = std::clamp(x.wind.z(), -2.0 * o.initial_wind_down, 2.0 * o.initial_wind_down);

  auto& P = start.P;
  P.setZero();
  const auto diagonal = [&](int at, double sigma) { P(at, at) = sigma * sigma; };
  for (int i = 0; i < 3; ++i) {
    diagonal(Model::kAttitude + i, s.sigma.attitude);
    diagonal(Model::kVelocity + i, i < 2 ? s.sigma.velocity : s.sigma.velocity_down);
    diagonal(Model::kWind + i, i < 2 ? o.initial_wind : o.initial_wind_down);
  }
  P.template block<5, 5>(Model::kGust, Model::kGust) = Model::stationary_gust_covariance();
  if constexpr (Model::kHasImuBiases) {
    for (int i = 0; i < 3; ++i) {
      diagonal(Model::kImuBias + i, o.gyro_bias ? kGyroBiasPrior : 0.0);
      diagonal(Model::kImuBias + 3 + i, o.accel_bias ? kAccelBiasPrior : 0.0);
    }
  }
  if constexpr (Model::kHasAirDataErrors) {
    const int at = Model::kAirDataError;
    diagonal(at + Model::kAlphaBias, o.alpha_bias ? kVaneBiasPrior : 0.0);
    diagonal(at + Model::kBetaBias, o.beta_bias ? kVaneBiasPrior : 0.0);
    diagonal(at + Model::kAlphaScale, o.alpha_scale ? kAlphaScalePrior : 0.0);
    diagonal(at + Model::kPitotScale, o.pitot_scale ? kPitotScalePrior : 0.0);
    diagonal(at + Model::kPitotBias, o.pitot_bias ? kPitotBiasPrior : 0.0);
  }
  return start;
}

/// Copyable, so that the smoother can repeat stretches of it.
template <class Model>
class FlightRun {
 public:
  using Tape = estimation::SmootherTape<Model>;
  using Filter = estimation::ExtendedKalmanFilter<Model>;

  /// `first_output` is the index in `output_t` of the first stamp of the segment.
  FlightRun(const RunSetting<Model>& setting, const Segment& segment, const Start<Model>& start,
            const std::array<estimation::InnovationMonitor, kSensors>& monitors, std::size_t first_output)
      : setting_(&setting), end_(segment.end), t_(segment.begin), filter_(start.x, start.P), monitors_(monitors) {
    for (std::size_t i = 0; i < kSensors; ++i) {
      const auto& t = setting.streams->sensors[i].t;
      // What started the run is not used again.
      const bool used = i <= kVelDown;
      const auto it = used ? std::upper_bound(t.begin(), t.end(), t_) : std::lower_bound(t.begin(), t.end(), t_);
      next_[i] = static_cast<std::size_t>(it - t.begin());
      monitors_[i].restart();
    }
    const auto after = [&](const std::vector<double>& t) {
      return static_cast<std::size_t>(std::upper_bound(t.begin(), t.end(), t_) - t.begin());
    };
    next_gyro_ = after(setting.streams->gyro.t);
    next_accel_ = after(setting.streams->accel.t);
    gyro_cursor_ = next_gyro_ - 1;
    accel_cursor_ = next_accel_ - 1;
    next_output_ = first_output;
  }

  /// To the next event; false at the end of the segment.
  bool advance(Tape* tape) {
    const FlightStreams& s = *setting_->streams;
    double event = std::numeric_limits<double>::infinity();
    const auto earlier = [&event](const std::vector<double>& t, std::size_t i) {
      if (i < t.size() && t[i] < event) event = t[i];
    };
    for (std::size_t i = 0; i < kSensors; ++i) earlier(s.sensors[i].t, next_[i]);
    earlier(s.gyro.t, next_gyro_);
    earlier(s.accel.t, next_accel_);
    earlier(*setting_->output_t, next_output_);
    if (!(event <= end_)) return false;

    propagate_to(event, tape);
    while (next_gyro_ < s.gyro.t.size() && s.gyro.t[next_gyro_] <= t_) ++next_gyro_;
    while (next_accel_ < s.accel.t.size() && s.accel.t[next_accel_] <= t_) ++next_accel_;
    for (std::size_t i = 0; i < kSensors; ++i) {
      const Stream& stream = s.sensors[i];
      for (; next_[i] < stream.t.size() && stream.t[next_[i]] <= t_; ++next_[i]) {
        measure(static_cast<Sensor>(i), stream.v[next_[i]], stream.sigma, tape);
      }
    }
    at_output_ = next_output_ < setting_->output_t->size() && (*setting_->output_t)[next_output_] <= t_;
    if (at_output_) {
      filter_.mark(next_output_, tape);
      ++next_output_;
    }
    return true;
  }

  /// Whether the last `advance` reached an output stamp, and which.
  [[nodiscard]] bool at_output() const { return at_output_; }
  [[nodiscard]] std::size_t output() const { return next_output_ - 1; }
  [[nodiscard]] std::size_t next_output() const { return next_output_; }
  [[nodiscard]] double time() const { return t_; }
  [[nodiscard]] const Filter& filter() const { return filter_; }
  [[nodiscard]] const std::array<estimation::InnovationMonitor, kSensors>& monitors() const { return monitors_; }

 private:
  void propagate_to(double time, Tape* tape) {
    const double dt = time - t_;
    if (!(dt > 0.0)) return;
    const FlightStreams& s = *setting_->streams;
    typename Model::Input u;
    const double middle = t_ + 0.5 * dt;
    u.gyro = s.gyro.at(middle, gyro_cursor_);
    u.specific_force = s.accel.at(middle, accel_cursor_);
    u.airspeed = setting_->model.air_velocity(filter_.state()).norm();
    // Across missing samples the line between their neighbours stands for what was not seen.
    constexpr double kMissing = 2.5, kFactor = 1000.0;
    const auto sparse = [&](const VectorStream& v, std::size_t cursor) {
      return cursor + 1 < v.t.size() && v.t[cursor + 1] - v.t[cursor] > kMissing * v.interval;
    };
    if (sparse(s.gyro, gyro_cursor_) || sparse(s.accel, accel_cursor_)) u.imu_noise_factor = kFactor;
    rate_ = u.gyro - filter_.state().imu_bias.template head<3>();
    filter_.propagate(setting_->model, u, dt, tape);
    t_ = time;
  }

  void measure(Sensor which, double z, double sigma, Tape* tape) {
    const auto& x = filter_.state();
    const Model& model = setting_->model;
    const ReconstructOptions& o = *setting_->options;
    Prediction<Model> p;
    double nu = 0.0;
    switch (which) {
      case kRoll:
      case kPitch:
      case kYaw: {
        bool usable = false;
        p = predict_euler_angle<Model>(x, which - kRoll, usable);
        if (!usable) return;
        nu = numerics::wrap_angle(z - p.value);
        break;
      }
      case kVelNorth:
      case kVelEast:
      case kVelDown:
        p = predict_ground_velocity<Model>(x, which - kVelNorth);
        nu = z - p.value;
        break;
      case kPitot:
        p = setting_->streams->pitot_is_pressure
                ? predict_dynamic_pressure(model, x, setting_->streams->density_at(t_, density_cursor_))
                : predict_airspeed(model, x);
        nu = z - p.value;
        break;
      case kAlpha:
      case kBeta: {
        const Eigen::Vector3d v = model.air_velocity(x);
        if (v.norm() < o.min_airspeed) return;
        const Eigen::Vector3d arm = rate_.cross(o.vane_position);
        p = which == kAlpha ? predict_alpha(model, x, arm) : predict_beta(model, x, arm, o.beta_is_flank);
        nu = numerics::wrap_angle(z - p.value);
        break;
      }
    }
    filter_.update(t_, nu, p.H, sigma * sigma, monitors_[which], tape);
  }

  const RunSetting<Model>* setting_;
  double end_;
  double t_;
  Filter filter_;
  std::array<estimation::InnovationMonitor, kSensors> monitors_;
  std::array<std::size_t, kSensors> next_{};
  std::size_t next_gyro_ = 0, next_accel_ = 0, next_output_ = 0;
  std::size_t gyro_cursor_ = 0, accel_cursor_ = 0, density_cursor_ = 0;
  Eigen::Vector3d rate_ = Eigen::Vector3d::Zero();
  bool at_output_ = false;
};

}  // namespace veridyn::aircraft::internal
