#include "veridyn/recording/inertial_consistency.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/regression/regression.hpp"
#include "veridyn/numerics/rotation.hpp"
#include "veridyn/recording/grid_signals.hpp"

namespace veridyn::recording {
namespace {

using estimation::Evidence;
using estimation::RegressionData;
using Vector3 = numerics::Vector3<double>;
using Matrix3 = numerics::Matrix3<double>;
using Series = std::vector<double>;

/// Length of a window [s]: longer ones average the noise of a fix, shorter ones keep more of the motion.
constexpr double kVelocityWindow_s = 1.0;
constexpr double kVelocityHop_s = 0.25;
constexpr double kAttitudeWindow_s = 0.5;
constexpr double kAttitudeHop_s = 0.1;
constexpr std::size_t kFewestWindows = 60;
/// Near the vertical the rates of roll and yaw become one and large: windows that pitch further are left out [rad].
constexpr double kSteepest = 60.0 * kDegree;

/// Unknowns: nine elements of the inverse gain, row by row, then three offsets.
constexpr Eigen::Index kUnknowns = 12;
/// Delays that may be unknown too: of the sensor and of what it is compared with.
constexpr Eigen::Index kDelays = 2;

/// Accelerometer, gyro and attitude on one grid.
struct InertialSeries {
  numerics::UniformGrid grid;
  std::array<Series, 3> force, rate, angle;

  [[nodiscard]] Vector3 f(std::size_t k) const { return {force[0][k], force[1][k], force[2][k]}; }
  [[nodiscard]] Vector3 w(std::size_t k) const { return {rate[0][k], rate[1][k], rate[2][k]}; }
};

bool has_all(const Recording& recording, std::initializer_list<const char*> names) {
  return std::ranges::all_of(names,
                             [&](const char* name) { return recording.has(name) && recording.at(name).size() > 1; });
}

InertialSeries on_one_grid(const Recording& recording) {
  const Channel& clock = recording.at("gyro_x");
  InertialSeries s;
  s.grid = grid_over(clock, grid_rate(clock), recording.source);
  const auto plain = [&](const char* name) {
    return on_grid(recording.at(name), s.grid, Holes::kOfHalfASecond, numerics::Interpolation::kLinear);
  };
  if (recording.has("accel_x")) s.force = {plain("accel_x"), plain("accel_y"), plain("accel_z")};
  s.rate = {plain("gyro_x"), plain("gyro_y"), plain("gyro_z")};
  s.angle = {angle_on_grid(recording.at("roll"), s.grid), angle_on_grid(recording.at("pitch"), s.grid),
             angle_on_grid(recording.at("yaw"), s.grid)};
  return s;
}

/// A window of time that begins and ends at samples of the reference: their indices.
struct Window {
  double begin, end;
  std::size_t first, last;
};

/// Windows of about `length` inside the spans. They overlap: one begins `hop` after the other, so that the noise at
/// their ends averages out (the regression allows for the correlation that this makes).
std::vector<Window> windows(std::span<const double> stamps, std::span<const TimeSpan> spans, double length,
                            double hop) {
  std::vector<Window> found;
  constexpr double kRounding = 0.999;
  for (const TimeSpan& span : spans) {
    const auto inside = std::ranges::lower_bound(stamps, span.begin) - stamps.begin();
    double last_begin = -kInfinity;
    std::size_t end = static_cast<std::size_t>(inside);
    for (auto begin = static_cast<std::size_t>(inside); begin < stamps.size(); ++begin) {
      if (stamps[begin] - last_begin < kRounding * hop) continue;
      while (end < stamps.size() && stamps[end] - stamps[begin] < kRounding * length) ++end;
      if (end >= stamps.size() || stamps[end] > span.end) break;
      last_begin = stamps[begin];
      if (stamps[end] - stamps[begin] < 2.0 * length) found.push_back({stamps[begin], stamps[end], begin, end});
    }
  }
  return found;
}

/// Mean over a window of a 3 x 12 matrix that is known at each moment of the grid; NaN where it is missing somewhere.
template <typename AtMoment>
Eigen::Matrix<double, 3, kUnknowns> mean_over(const Window& window, const numerics::UniformGrid& grid,
                                              const AtMoment& at_moment) {
  Eigen::Matrix<double, 3, kUnknowns> sum = Eigen::Matrix<double, 3, kUnknowns>::Zero();
  const double h = grid.step;
  const auto first = static_cast<std::size_t>(std::max(0.0, std::floor((window.begin - grid.begin) / h)));
  for (std::size_t k = first; k < grid.count && grid.at(k) - 0.5 * h < window.end; ++k) {
    const double overlap = std::min(window.end, grid.at(k) + 0.5 * h) - std::max(window.begin, grid.at(k) - 0.5 * h);
    if (overlap > 0.0) sum += overlap * at_moment(k);
  }
  return sum / (window.end - window.begin);
}

/// Regressors of truth = T (N reading - N b): T's columns times the reading, then T itself.
Eigen::Matrix<double, 3, kUnknowns> regressors(const Matrix3& T, const Vector3& reading) {
  Eigen::Matrix<double, 3, kUnknowns> X;
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < 3; ++j) X.col(3 * i + j) = T.col(i) * reading(j);
    X.col(9 + i) = T.col(i);
  }
  return X;
}

/// Rows of three axes as they come.
class Equations {
 public:
  using Delays = Eigen::Matrix<double, 3, kDelays>;

  void add(const Eigen::Matrix<double, 3, kUnknowns>& X, const Vector3& z, const Delays& delays = Delays::Zero()) {
    if (!X.allFinite() || !z.allFinite() || !delays.allFinite()) return;
    Row row{{}, z};
    row.X << X, delays;
    rows_.push_back(row);
  }
  [[nodiscard]] std::optional<SensorMatrix> solve() const;
  /// The first delay with its standard error, all unknowns estimated together.
  [[nodiscard]] std::optional<std::pair<double, double>> delay() const;

 private:
  struct Row {
    Eigen::Matrix<double, 3, kUnknowns + kDelays> X;
    Vector3 z;
  };
  [[nodiscard]] RegressionData data(Eigen::Index unknowns) const;
  [[nodiscard]] static std::optional<estimation::RegressionEstimate> least_squares(const RegressionData& data);

  std::vector<Row> rows_;
};

/// Gain and bias from the inverse gain N and offset c (truth = N reading + c): reading = G truth - G c, with
/// dG = -G dN G.
SensorMatrix inverted(const Eigen::VectorXd& theta, const Eigen::MatrixXd& covariance) {
  Matrix3 N;
  for (Eigen::Index i = 0; i < 3; ++i) N.row(i) = theta.segment<3>(3 * i).transpose();
  SensorMatrix m;
  m.gain = N.inverse();
  m.bias = -m.gain * theta.tail<3>();
  const Matrix3& G = m.gain;
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      Eigen::VectorXd slope = Eigen::VectorXd::Zero(kUnknowns);
      for (Eigen::Index k = 0; k < 3; ++k)
        for (Eigen::Index l = 0; l < 3; ++l) slope(3 * k + l) = -G(i, k) * G(l, j);
      m.gain_sigma(i, j) = std::sqrt(std::max(0.0, slope.dot(covariance * slope)));
    }
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(kUnknowns);
    slope.tail<3>() = -G.row(i).transpose();
    // The offset's own part: -G dc + G dN G c.
    const Vector3 Gc = G * theta.tail<3>();
    for (Eigen::Index k = 0; k < 3; ++k)
      for (Eigen::Index l = 0; l < 3; ++l) slope(3 * k + l) = G(i, k) * Gc(l);
    m.bias_sigma(i) = std::sqrt(std::max(0.0, slope.dot(covariance * slope)));
  }
  return m;
}

RegressionData Equations::data(Eigen::Index unknowns) const {
  const auto n = signed_index(rows_.size());
  RegressionData data;
  data.regressors.resize(3 * n, unknowns);
  data.regressand.resize(3 * n);
  data.segment.resize(3 * rows_.size());
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (Eigen::Index k = 0; k < n; ++k) {
      data.regressors.row(axis * n + k) = rows_[k].X.row(axis).head(unknowns);
      data.regressand(axis * n + k) = rows_[k].z(axis);
      data.segment[axis * n + k] = static_cast<int>(axis);
    }
  }
  for (Eigen::Index j = 0; j < unknowns; ++j) data.parameter_names.push_back(fmt::format("n{}", j));
  return data;
}

std::optional<estimation::RegressionEstimate> Equations::least_squares(const RegressionData& data) {
  estimation::RegressionOptions options;
  options.max_lag = 20;
  estimation::RegressionEstimate estimate = estimation::estimate(data, estimation::Method::kOls, options);
  if (!estimate.usable() || !estimate.covariance.allFinite()) return std::nullopt;
  return estimate;
}

std::optional<std::pair<double, double>> Equations::delay() const {
  if (rows_.size() < kFewestWindows) return std::nullopt;
  const auto estimate = least_squares(data(kUnknowns + kDelays));
  if (!estimate) return std::nullopt;
  return std::pair{estimate->theta(kUnknowns), std::sqrt(estimate->covariance(kUnknowns, kUnknowns))};
}

std::optional<SensorMatrix> Equations::solve() const {
  const auto n = signed_index(rows_.size());
  if (rows_.size() < kFewestWindows) return std::nullopt;
  const RegressionData data = this->data(kUnknowns);
  const auto estimated = least_squares(data);
  if (!estimated) return std::nullopt;
  const estimation::RegressionEstimate& estimate = *estimated;
  SensorMatrix m = inverted(estimate.theta, estimate.covariance);
  if (!m.gain.allFinite()) return std::nullopt;
  const Eigen::VectorXd residual = data.regressand - data.regressors * estimate.theta;
  m.residual_rms = std::sqrt(residual.squaredNorm() / static_cast<double>(3 * n));
  double power = 0.0;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto z = data.regressand.segment(axis * n, n);
    power += (z.array() - z.mean()).square().sum();
  }
  m.signal_rms = std::sqrt(power / static_cast<double>(3 * n));
  m.rows = n;
  return m;
}

Matrix3 ned_from_body(const InertialSeries& s, std::size_t k) {
  return numerics::R_body_from_ned(s.angle[0][k], s.angle[1][k], s.angle[2][k]).transpose();
}

/// [phi', theta', psi'] = E(phi, theta) [p, q, r].
Matrix3 euler_rate_matrix(double phi, double theta) {
  Matrix3 E;
  for (Eigen::Index i = 0; i < 3; ++i) E.col(i) = numerics::euler_rates(phi, theta, Vector3(Vector3::Unit(i)));
  return E;
}

/// What delays tau_f of the specific force and tau_v of the velocity make of the mean acceleration over a window:
/// tau_f (1/T) integral of R f' - tau_v (1/T) [R f], with integral of R f' = [R f] - integral of R (w x f).
Equations::Delays delays_over(const InertialSeries& s, const Window& window) {
  const double h = s.grid.step;
  const auto index = [&](double t) {
    return static_cast<std::size_t>(
        std::clamp(std::round((t - s.grid.begin) / h), 0.0, static_cast<double>(s.grid.count - 1)));
  };
  const std::size_t first = index(window.begin), last = index(window.end);
  // The mean of some samples at either end: their noise is what limits a difference.
  constexpr std::size_t kHalf = 3;
  const auto force_at = [&](std::size_t k) {
    Vector3 sum = Vector3::Zero();
    double count = 0.0;
    for (std::size_t i = k > kHalf ? k - kHalf : 0; i <= std::min(s.grid.count - 1, k + kHalf); ++i, count += 1.0)
      sum += ned_from_body(s, i) * s.f(i);
    return Vector3(sum / count);
  };
  Vector3 turning = Vector3::Zero();
  for (std::size_t k = first; k < last; ++k) turning += h * (ned_from_body(s, k) * s.w(k).cross(s.f(k)));
  const Vector3 change = force_at(last) - force_at(first);
  const double T = window.end - window.begin;
  Equations::Delays delays;
  delays.col(0) = (change - turning) / T;
  delays.col(1) = -change / T;
  return delays;
}

/// What only the velocity says: all but `gyro`.
InertialConsistency compare_velocity(const Recording& recording, const InertialSeries& s,
                                     std::span<const TimeSpan> spans) {
  InertialConsistency out;
  const Channel& north = recording.at("vel_north");
  const Channel& east = recording.at("vel_east");
  const Channel& down = recording.at("vel_down");
  if (east.size() != north.size() || down.size() != north.size()) return out;
  const Vector3 gravity(0.0, 0.0, kGravity);
  Equations by_force, by_velocity;
  for (const Window& window : windows(north.times(), spans, kVelocityWindow_s, kVelocityHop_s)) {
    const auto v = [&](std::size_t i) { return Vector3(north.value[i], east.value[i], down.value[i]); };
    const Vector3 acceleration = (v(window.last) - v(window.first)) / (window.end - window.begin);
    const auto X = mean_over(window, s.grid, [&](std::size_t k) { return regressors(ned_from_body(s, k), s.f(k)); });
    by_force.add(X, acceleration - gravity, delays_over(s, window));
    // Columns of the unit gain: what the accelerometer says as it is.
    const Vector3 said = X.col(0) + X.col(4) + X.col(8) + gravity;
    by_velocity.add(regressors(Matrix3::Identity(), acceleration), said);
  }
  out.accelerometer = by_force.solve();
  if (const auto delay = by_force.delay()) {
    out.accelerometer_delay = delay->first;
    out.accelerometer_delay_sigma = delay->second;
  }
  out.velocity = by_velocity.solve();
  return out;
}

std::optional<SensorMatrix> compare_rates(const Recording& recording, const InertialSeries& s,
                                          std::span<const TimeSpan> spans) {
  const std::vector<double> stamps(recording.at("roll").times().begin(), recording.at("roll").times().end());
  Equations equations;
  for (const Window& window : windows(stamps, spans, kAttitudeWindow_s, kAttitudeHop_s)) {
    const auto index = [&](double t) {
      return static_cast<std::size_t>(
          std::clamp(std::round((t - s.grid.begin) / s.grid.step), 0.0, static_cast<double>(s.grid.count - 1)));
    };
    const std::size_t first = index(window.begin), last = index(window.end);
    const Window on_grid{s.grid.at(first), s.grid.at(last), first, last};
    const auto steep = [](double pitch) { return !(std::abs(pitch) < kSteepest); };
    const auto from = s.angle[1].begin() + signed_index(first);
    if (!(on_grid.end > on_grid.begin) || std::any_of(from, from + signed_index(last - first) + 1, steep)) continue;
    Vector3 change;
    for (std::size_t i = 0; i < 3; ++i) change(i) = s.angle[i][last] - s.angle[i][first];
    const auto X = mean_over(on_grid, s.grid, [&](std::size_t k) {
      return regressors(euler_rate_matrix(s.angle[0][k], s.angle[1][k]), s.w(k));
    });
    equations.add(X, change / (on_grid.end - on_grid.begin));
  }
  return equations.solve();
}

Evidence delay_row(double delay_s, double sigma_s) {
  constexpr double kCare_s = 0.02;
  constexpr double kFailed_s = 0.2;
  Evidence row{
      .name = "delay of the accelerometer",
      .about = "accelerometer and gyro",
      .outcome = estimation::outcome_of(delay_s, sigma_s, estimation::Tolerance::about(0.0, kCare_s, kFailed_s)),
      .value = delay_s,
      .limit = kCare_s,
      .scale = "s",
      .text = fmt::format("the accelerometer is {:.3f} +- {:.3f} s {} gyro and attitude", std::abs(delay_s), sigma_s,
                          delay_s < 0.0 ? "before" : "behind"),
      .bears_on = estimation::kAllPurposes};
  if (!row.passed()) row.advice = "check the stamps of accelerometer and gyro, and the filters that they went through";
  return row;
}

}  // namespace

InertialConsistency inertial_consistency(const Recording& recording, std::span<const TimeSpan> spans) {
  InertialConsistency out;
  if (!has_all(recording, {"gyro_x", "gyro_y", "gyro_z", "roll", "pitch", "yaw"})) return out;
  const InertialSeries series = on_one_grid(recording);
  if (has_all(recording, {"accel_x", "accel_y", "accel_z", "vel_north", "vel_east", "vel_down"}))
    out = compare_velocity(recording, series, spans);
  out.gyro = compare_rates(recording, series, spans);
  return out;
}

std::vector<Evidence> inertial_evidence(const InertialConsistency& c) {
  constexpr SensorTolerance kForce{.gain_care = 0.02, .gain_failed = 0.15, .bias_care = 0.1, .bias_failed = 1.0};
  constexpr SensorTolerance kVelocity{.gain_care = 0.02, .gain_failed = 0.15, .bias_care = 0.2, .bias_failed = 2.0};
  constexpr SensorTolerance kRate{
      .gain_care = 0.02, .gain_failed = 0.15, .bias_care = 0.3 * kDegree, .bias_failed = 5.0 * kDegree};
  const SensorNames force{"accelerometer", "velocity and attitude", {"x", "y", "z"}, "m/s^2"};
  const SensorNames velocity{
      "ground velocity", "accelerometer and attitude", {"north", "east", "down"}, "m/s^2 of its derivative"};
  const SensorNames rate{"gyro", "the attitude", {"x", "y", "z"}, "rad/s"};
  std::vector<Evidence> rows;
  const auto add = [&](const SensorMatrix& matrix, const SensorNames& names, const SensorTolerance& tolerance) {
    for (Evidence& row : sensor_matrix_evidence(matrix, names, tolerance)) rows.push_back(std::move(row));
  };
  const auto failed = [&](const std::string& sensor) {
    return std::ranges::any_of(
        rows, [&](const Evidence& row) { return row.about == sensor && row.outcome == estimation::Outcome::kFailed; });
  };
  if (c.accelerometer) {
    // The same contradiction read the other way: a wrong velocity leaves less unexplained than a wrong accelerometer,
    // and without a bias: the derivative of a velocity has none, while a wrong specific force shows gravity as one.
    constexpr double kClearlyBetter = 0.7;
    // Where the gyro contradicts the attitude too, the attitude is the suspect.
    const bool attitude_holds = !c.gyro || !gain_fault(*c.gyro, rate, kRate.gain_failed);
    const bool rather_velocity = attitude_holds && gain_fault(*c.accelerometer, force, kForce.gain_failed) &&
                                 c.velocity && gain_fault(*c.velocity, velocity, kVelocity.gain_failed) &&
                                 c.velocity->bias.cwiseAbs().maxCoeff() < kVelocity.bias_failed &&
                                 c.velocity->unexplained() < kClearlyBetter * c.accelerometer->unexplained();
    if (rather_velocity)
      add(*c.velocity, velocity, kVelocity);
    else
      add(*c.accelerometer, force, kForce);
  }
  if (c.gyro) add(*c.gyro, rate, kRate);
  if (c.accelerometer_delay) rows.push_back(delay_row(*c.accelerometer_delay, c.accelerometer_delay_sigma));
  if (failed("gyro") && failed("accelerometer")) {
    rows.push_back(
        {.name = "attitude against gyro and accelerometer",
         .about = "attitude",
         .outcome = estimation::Outcome::kFailed,
         .value = kNaN,
         .limit = kNaN,
         .text = "gyro and accelerometer both contradict the attitude: rather than both of them, it is wrong",
         .bears_on = estimation::kAllPurposes,
         .advice = "check signs, units and order of roll, pitch and yaw in [data.map]"});
  }
  return rows;
}

}  // namespace veridyn::recording
