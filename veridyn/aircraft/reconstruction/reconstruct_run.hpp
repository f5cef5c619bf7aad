#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "veridyn/aircraft/reconstruction/air_data_measurement.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_streams.hpp"
#include "veridyn/estimation/kalman/kalman_filter.hpp"
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
  /// Errors of the air data that are taken as known (see AirDataModel::AirDataErrorIndex).
  Eigen::Matrix<double, 5, 1> air_error = Eigen::Matrix<double, 5, 1>::Zero();
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
  const auto& e = x.air_error = setting.air_error;
  double airspeed = median_within(s.sensors[kPitot], segment.begin, kWindow);
  if (std::isfinite(airspeed) && s.pitot_is_pressure) {
    std::size_t cursor = 0;
    airspeed = std::sqrt(2.0 * std::max((airspeed - e(Model::kPitotBias)) / (1.0 + e(Model::kPitotScale)), 0.0) /
                         s.density_at(segment.begin, cursor));
  }
  const double alpha =
      (median_within(s.sensors[kAlpha], segment.begin, kWindow) - e(Model::kAlphaBias)) / (1.0 + e(Model::kAlphaScale));
  const double beta = median_within(s.sensors[kBeta], segment.begin, kWindow) - e(Model::kBetaBias);
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
  if constexpr (Model::kHasImuScales) {
    for (int i = 0; i < 3; ++i) {
      diagonal(Model::kImuScale + i, o.gyro_scale ? kImuScalePrior : 0.0);
      diagonal(Model::kImuScale + 3 + i, o.accel_scale ? kImuScalePrior : 0.0);
    }
  }
  if constexpr (Model::kHasAerodynamics) {
    for (int i = 0; i < 3; ++i)
      diagonal(Model::kCoefficientError + i, setting.model.error.sigma(static_cast<std::size_t>(i)));
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

/// Goes through the samples of all sensors in the order of their stamps.
class EventCursor {
 public:
  /// `first_output` is the index in `output_t` of the first stamp of the segment.
  EventCursor(const FlightStreams& streams, const std::vector<double>& output_t, const Segment& segment,
              std::size_t first_output)
      : streams_(&streams), output_t_(&output_t), end_(segment.end), t_(segment.begin), next_output_(first_output) {
    for (std::size_t i = 0; i < kSensors; ++i) {
      const auto& t = streams.sensors[i].t;
      // What started the run is not used again.
      const bool used = i <= kVelDown;
      const auto it = used ? std::upper_bound(t.begin(), t.end(), t_) : std::lower_bound(t.begin(), t.end(), t_);
      next_[i] = static_cast<std::size_t>(it - t.begin());
    }
    const auto after = [&](const std::vector<double>& t) {
      return static_cast<std::size_t>(std::upper_bound(t.begin(), t.end(), t_) - t.begin());
    };
    next_gyro_ = after(streams.gyro.t);
    next_accel_ = after(streams.accel.t);
    gyro_cursor_ = next_gyro_ - 1;
    accel_cursor_ = next_accel_ - 1;
  }

  /// Time of the next event; NaN at the end of the segment.
  [[nodiscard]] double next_time() const {
    double event = std::numeric_limits<double>::infinity();
    const auto earlier = [&event](const std::vector<double>& t, std::size_t i) {
      if (i < t.size() && t[i] < event) event = t[i];
    };
    for (std::size_t i = 0; i < kSensors; ++i) earlier(streams_->sensors[i].t, next_[i]);
    earlier(streams_->gyro.t, next_gyro_);
    earlier(streams_->accel.t, next_accel_);
    earlier(*output_t_, next_output_);
    return event <= end_ ? event : std::numeric_limits<double>::quiet_NaN();
  }

  /// Inertial measurements, and controls where `with_controls`, for the way from here to `time`.
  template <class Input>
  void fill(Input& u, double time) {
    const double middle = t_ + 0.5 * (time - t_);
    const FlightStreams& s = *streams_;
    u.gyro = s.gyro.at(middle, gyro_cursor_);
    u.specific_force = s.accel.at(middle, accel_cursor_);
    // Across missing samples the line between their neighbours stands for what was not seen.
    constexpr double kMissing = 2.5, kFactor = 1000.0;
    const auto sparse = [&](const VectorStream& v, std::size_t cursor) {
      return cursor + 1 < v.t.size() && v.t[cursor + 1] - v.t[cursor] > kMissing * v.interval;
    };
    if (sparse(s.gyro, gyro_cursor_) || sparse(s.accel, accel_cursor_)) u.imu_noise_factor = kFactor;
    if constexpr (requires { u.controls; }) {
      u.controls = s.controls.at(middle, control_cursor_);
      u.air_density = s.density_at(middle, density_cursor_);
    }
  }

  /// What a sample at the present time means. The gyro is the one of the last step's middle.
  [[nodiscard]] MeasurementContext context(const ReconstructOptions& o, bool with_controls) {
    const FlightStreams& s = *streams_;
    MeasurementContext c;
    c.t = t_;
    c.pitot_is_pressure = s.pitot_is_pressure;
    c.air_density = s.density_at(t_, density_cursor_);
    c.vane_position = o.vane_position;
    c.beta_is_flank = o.beta_is_flank;
    c.min_airspeed = o.min_airspeed;
    c.gyro = s.gyro.at(t_, gyro_cursor_);
    c.gyro_sigma = s.sigma.gyro;
    if (with_controls) c.controls = s.controls.at(t_, control_cursor_);
    return c;
  }

  /// To `time`; calls `sample(sensor, value, sigma)` for each that is due, the attitude first.
  template <class OnSample>
  void step_to(double time, OnSample&& sample) {
    t_ = time;
    const FlightStreams& s = *streams_;
    while (next_gyro_ < s.gyro.t.size() && s.gyro.t[next_gyro_] <= t_) ++next_gyro_;
    while (next_accel_ < s.accel.t.size() && s.accel.t[next_accel_] <= t_) ++next_accel_;
    for (std::size_t i = 0; i < kSensors; ++i) {
      const Stream& stream = s.sensors[i];
      for (; next_[i] < stream.t.size() && stream.t[next_[i]] <= t_; ++next_[i]) {
        sample(static_cast<Sensor>(i), stream.v[next_[i]], stream.sigma);
      }
    }
    at_output_ = next_output_ < output_t_->size() && (*output_t_)[next_output_] <= t_;
    if (at_output_) ++next_output_;
  }

  /// Whether the last step reached an output stamp, and which.
  [[nodiscard]] bool at_output() const { return at_output_; }
  [[nodiscard]] std::size_t output() const { return next_output_ - 1; }
  [[nodiscard]] double time() const { return t_; }

 private:
  const FlightStreams* streams_;
  const std::vector<double>* output_t_;
  double end_;
  double t_;
  std::array<std::size_t, kSensors> next_{};
  std::size_t next_gyro_ = 0, next_accel_ = 0, next_output_ = 0;
  std::size_t gyro_cursor_ = 0, accel_cursor_ = 0, density_cursor_ = 0;
  ControlStreams::Cursor control_cursor_;
  bool at_output_ = false;
};

/// One filter through one segment. Copyable, so that the smoother can repeat stretches of it.
template <class Model>
class FlightRun {
 public:
  using Tape = estimation::SmootherTape<Model>;
  using Filter = estimation::ExtendedKalmanFilter<Model>;

  FlightRun(const RunSetting<Model>& setting, const Segment& segment, const Start<Model>& start,
            const std::array<estimation::InnovationMonitor, kSensors>& monitors, std::size_t first_output)
      : setting_(&setting),
        cursor_(*setting.streams, *setting.output_t, segment, first_output),
        filter_(start.x, start.P),
        monitors_(monitors) {
    for (auto& monitor : monitors_) monitor.restart();
  }

  /// To the next event; false at the end of the segment.
  bool advance(Tape* tape) {
    const double time = cursor_.next_time();
    if (!std::isfinite(time)) return false;
    propagate_to(time, tape);
    if (keep_innovations_) innovations_.clear();
    bool known = false;
    MeasurementContext context;
    cursor_.step_to(time, [&](Sensor which, double z, double sigma) {
      if (!known) context = cursor_.context(*setting_->options, Model::kHasAerodynamics);
      known = true;
      estimation::Innovation seen;
      const bool offered =
          enter_measurement<Model>(filter_, setting_->model, context, which, z, sigma, monitors_[which], tape, &seen);
      if (keep_innovations_) {
        seen.accepted = seen.accepted && offered;
        innovations_.push_back(seen);
      }
    });
    if (cursor_.at_output()) filter_.mark(cursor_.output(), tape);
    return true;
  }

  [[nodiscard]] bool at_output() const { return cursor_.at_output(); }
  [[nodiscard]] std::size_t output() const { return cursor_.output(); }
  [[nodiscard]] double time() const { return cursor_.time(); }
  /// The samples of the last event, where `keep_innovations` was called.
  [[nodiscard]] const std::vector<estimation::Innovation>& innovations() const { return innovations_; }
  void keep_innovations() { keep_innovations_ = true; }
  [[nodiscard]] const Filter& filter() const { return filter_; }
  [[nodiscard]] const std::array<estimation::InnovationMonitor, kSensors>& monitors() const { return monitors_; }

 private:
  void propagate_to(double time, Tape* tape) {
    const double dt = time - cursor_.time();
    if (!(dt > 0.0)) return;
    typename Model::Input u;
    cursor_.fill(u, time);
    u.airspeed = setting_->model.air_velocity(filter_.state()).norm();
    filter_.propagate(setting_->model, u, dt, tape);
  }

  const RunSetting<Model>* setting_;
  EventCursor cursor_;
  Filter filter_;
  std::array<estimation::InnovationMonitor, kSensors> monitors_;
  std::vector<estimation::Innovation> innovations_;
  bool keep_innovations_ = false;
};

}  // namespace veridyn::aircraft::internal
