#include "veridyn/aircraft/reconstruction/reconstruct_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/rank.hpp"
#include "veridyn/numerics/rotation.hpp"

namespace veridyn::aircraft::internal {

double median_within(const Stream& s, double from, double window) {
  const auto first = std::lower_bound(s.t.begin(), s.t.end(), from);
  const auto last = std::upper_bound(first, s.t.end(), from + window);
  if (first == last) return kNaN;
  return upper_median(std::vector<double>(s.v.begin() + (first - s.t.begin()), s.v.begin() + (last - s.t.begin())));
}

namespace {

/// Where roll and pitch are not recorded, of the first estimate of them.
constexpr double kUnknownTilt = 15.0 * kDegree;
/// Where neither heading nor ground velocity tell the direction, it is of no consequence.
constexpr double kLargestCrab = 0.5;

/// Attitude of the first moment, and how well it is known: of roll, pitch and yaw.
struct FirstAttitude {
  std::array<double, 3> angle{}, sigma{};

  /// Covariance of a small turn in body axes.
  [[nodiscard]] Eigen::Matrix3d covariance() const {
    const double cf = std::cos(angle[0]), sf = std::sin(angle[0]), ct = std::cos(angle[1]), st = std::sin(angle[1]);
    Eigen::Matrix3d E;
    E << 1.0, 0.0, -st, 0.0, cf, sf * ct, 0.0, -sf, cf * ct;
    const Eigen::Vector3d variance(sigma[0] * sigma[0], sigma[1] * sigma[1], sigma[2] * sigma[2]);
    return E * variance.asDiagonal() * E.transpose();
  }
};

/// What the recording lacks is taken from steady flight along the ground velocity: wings level, the specific force
/// against gravity, no crab angle but the wind's.
FirstAttitude first_attitude(const RunSetting& setting, const Segment& segment,
                             const EnumArray<Sensor, double, kSensors>& first) {
  const FlightStreams& s = *setting.streams;
  FirstAttitude start{.angle = {first[kRoll], first[kPitch], first[kYaw]},
                      .sigma = {s.sigma.attitude, s.sigma.attitude, s.sigma.attitude}};
  if (!s.has(kRoll)) start.angle[0] = 0.0, start.sigma[0] = kUnknownTilt;
  if (!s.has(kPitch)) {
    std::size_t cursor = 0;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    constexpr int kMoments = 20;
    for (int i = 0; i < kMoments; ++i) mean += s.accel.at(segment.begin + 0.05 * i, cursor) / kMoments;
    start.angle[1] = std::asin(std::clamp(mean.x() / kGravity, -0.5, 0.5));
    start.sigma[1] = kUnknownTilt;
  }
  if (!s.has(kYaw)) {
    const double speed = std::hypot(first[kVelNorth], first[kVelEast]);
    start.angle[2] = s.has_ground_velocity() ? std::atan2(first[kVelEast], first[kVelNorth]) : 0.0;
    if (s.has_ground_velocity())
      start.sigma[2] = std::min(kLargestCrab, std::atan2(setting.options->initial_wind, speed));
  }
  return start;
}

}  // namespace

Start start_of(const RunSetting& setting, const Segment& segment) {
  const FlightStreams& s = *setting.streams;
  const ReconstructOptions& o = *setting.options;
  EnumArray<Sensor, double, kSensors> first{};
  for (const Sensor which : {kRoll, kPitch, kYaw, kVelNorth, kVelEast, kVelDown}) {
    const Stream& stream = s.sensors[which];
    if (stream.t.empty()) continue;
    const auto it = std::upper_bound(stream.t.begin(), stream.t.end(), segment.begin);
    first[which] = stream.v[std::max<std::ptrdiff_t>(it - stream.t.begin() - 1, 0)];
  }
  Start start;
  auto& x = start.x;
  const FirstAttitude attitude = first_attitude(setting, segment, first);
  x.attitude = numerics::quaternion_from_euler(attitude.angle[0], attitude.angle[1], attitude.angle[2]);
  x.velocity = Eigen::Vector3d(first[kVelNorth], first[kVelEast], first[kVelDown]);

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
  const bool over_ground = s.has_ground_velocity();
  if (!std::isfinite(airspeed)) airspeed = ground.norm();
  Eigen::Vector3d direction = ground.norm() > 1.0 ? Eigen::Vector3d(ground.normalized()) : Eigen::Vector3d::UnitX();
  if (std::isfinite(alpha) || std::isfinite(beta) || !over_ground) {
    // In level flight alpha is what pitch is.
    const double level = over_ground ? 0.0 : std::clamp(attitude.angle[1], -0.2, 0.2);
    const double a = std::isfinite(alpha) ? std::clamp(alpha, -0.5, 0.5) : level;
    const double b = std::isfinite(beta) ? std::clamp(beta, -0.5, 0.5) : 0.0;
    direction = Eigen::Vector3d(std::cos(a) * std::cos(b), std::sin(b), std::sin(a) * std::cos(b));
  }
  const Eigen::Vector3d through_air = x.attitude * Eigen::Vector3d(direction * airspeed);
  if (!over_ground) x.velocity.head<2>() = through_air.head<2>();
  if (!s.has(kVelDown)) x.velocity.z() = through_air.z();
  x.wind = x.velocity - through_air;
  x.wind.z() = std::clamp(x.wind.z(), -2.0 * o.initial_wind_down, 2.0 * o.initial_wind_down);

  using Errors = AirDataErrorVector;
  const auto diagonal = [&](int at, double sigma) { start.variance(at) = sigma * sigma; };
  // A velocity that follows from the first air data has their gust, and an angle that no vane measures.
  const DrydenSettings& gusts = setting.motion.spectrum;
  const double by_air_data = std::hypot(std::max({gusts.sigma_u, gusts.sigma_v, gusts.sigma_w}), 0.1 * airspeed);
  const double horizontal = over_ground ? s.sigma.velocity : by_air_data;
  const double vertical = s.has(kVelDown) ? s.sigma.velocity_down : by_air_data;
  if (!s.has_tilt() || !s.has(kYaw)) start.attitude = attitude.covariance();
  for (int i = 0; i < 3; ++i) {
    const bool wind_shows = i < 2 ? over_ground : over_ground || s.has(kVelDown);
    diagonal(Errors::kAttitude + i, s.sigma.attitude);
    diagonal(Errors::kVelocity + i, i < 2 ? horizontal : vertical);
    diagonal(Errors::kWind + i, !wind_shows ? 0.0 : i < 2 ? o.initial_wind : o.initial_wind_down);
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
