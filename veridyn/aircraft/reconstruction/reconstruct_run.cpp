#include "veridyn/aircraft/reconstruction/reconstruct_run.hpp"

#include <algorithm>

#include "veridyn/core/constants.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::aircraft::internal {

double median_within(const Stream& s, double from, double window) {
  const auto first = std::lower_bound(s.t.begin(), s.t.end(), from);
  const auto last = std::upper_bound(first, s.t.end(), from + window);
  if (first == last) return kNaN;
  std::vector<double> v(s.v.begin() + (first - s.t.begin()), s.v.begin() + (last - s.t.begin()));
  std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
  return v[v.size() / 2];
}

Start start_of(const RunSetting& setting, const Segment& segment) {
  const FlightStreams& s = *setting.streams;
  const ReconstructOptions& o = *setting.options;
  const auto first = [&](Sensor which) {
    const Stream& stream = s.sensors[which];
    const auto it = std::upper_bound(stream.t.begin(), stream.t.end(), segment.begin);
    return stream.v[static_cast<std::size_t>(std::max<std::ptrdiff_t>(it - stream.t.begin() - 1, 0))];
  };
  Start start;
  auto& x = start.x;
  x.attitude = numerics::quaternion_from_euler(first(kRoll), first(kPitch), first(kYaw));
  x.velocity = Eigen::Vector3d(first(kVelNorth), first(kVelEast), first(kVelDown));

  // u_r = R v_ground scaled to |v_r| = Va, unless vanes show where the air comes from.
  constexpr double kWindow = 1.0;
  const auto& e = x.air_error = setting.air_error;
  double airspeed = median_within(s.sensors[kPitot], segment.begin, kWindow);
  if (std::isfinite(airspeed) && s.pitot_is_pressure) {
    std::size_t cursor = 0;
    airspeed = std::sqrt(
        2.0 * std::max((airspeed - e(AirDataMotion::kPitotBias)) / (1.0 + e(AirDataMotion::kPitotScale)), 0.0) /
        s.density_at(segment.begin, cursor));
  }
  const double alpha = (median_within(s.sensors[kAlpha], segment.begin, kWindow) - e(AirDataMotion::kAlphaBias)) /
                       (1.0 + e(AirDataMotion::kAlphaScale));
  const double beta = median_within(s.sensors[kBeta], segment.begin, kWindow) - e(AirDataMotion::kBetaBias);
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

  using Errors = AirDataErrorVector;
  const auto diagonal = [&](int at, double sigma) { start.variance(at) = sigma * sigma; };
  for (int i = 0; i < 3; ++i) {
    diagonal(Errors::kAttitude + i, s.sigma.attitude);
    diagonal(Errors::kVelocity + i, i < 2 ? s.sigma.velocity : s.sigma.velocity_down);
    diagonal(Errors::kWind + i, i < 2 ? o.initial_wind : o.initial_wind_down);
    diagonal(Errors::kCore + i, o.gyro_bias ? kGyroBiasPrior : 0.0);
    diagonal(Errors::kCore + 3 + i, o.accel_bias ? kAccelBiasPrior : 0.0);
    diagonal(Errors::kCore + 6 + i, o.gyro_scale ? kImuScalePrior : 0.0);
    diagonal(Errors::kCore + 9 + i, o.accel_scale ? kImuScalePrior : 0.0);
    diagonal(Errors::kCore + Errors::kImuErrors + i, setting.motion.error.sigma(static_cast<std::size_t>(i)));
  }
  return start;
}

EventCursor::EventCursor(const FlightStreams& streams, const std::vector<double>& output_t, const Segment& segment,
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

double EventCursor::next_time() const {
  double event = kInfinity;
  const auto earlier = [&event](const std::vector<double>& t, std::size_t i) {
    if (i < t.size() && t[i] < event) event = t[i];
  };
  for (std::size_t i = 0; i < kSensors; ++i) earlier(streams_->sensors[i].t, next_[i]);
  earlier(streams_->gyro.t, next_gyro_);
  earlier(streams_->accel.t, next_accel_);
  earlier(*output_t_, next_output_);
  return event <= end_ ? event : kNaN;
}

void EventCursor::fill(AirDataInput& u, double time, bool with_controls) {
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
  if (with_controls) {
    u.controls = s.controls.at(middle, control_cursor_);
    u.air_density = s.density_at(middle, density_cursor_);
  }
}

MeasurementContext EventCursor::context(const ReconstructOptions& o, bool with_controls) {
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

}  // namespace veridyn::aircraft::internal
