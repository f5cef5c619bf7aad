#include "veridyn/recording/inertial_consistency.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/estimation/judgement/check.hpp"
#include "veridyn/numerics/rotation.hpp"
#include "veridyn/recording/grid_signals.hpp"
#include "veridyn/recording/inertial_equations.hpp"

namespace veridyn::recording {
namespace {

using estimation::Cause;
using estimation::Check;
using estimation::Evidence;
using estimation::Outcome;
using internal::Equations;
using internal::kUnknowns;
using internal::Matrix3;
using internal::regressors;
using internal::Solved;
using internal::Vector3;
using Series = std::vector<double>;

/// Length of a window [s]: longer ones average the noise of a fix, shorter ones keep more of the motion.
constexpr double kVelocityWindow_s = 1.0;
constexpr double kVelocityHop_s = 0.25;
constexpr double kAttitudeWindow_s = 0.5;
constexpr double kAttitudeHop_s = 0.1;
/// Near the vertical the rates of roll and yaw become one and large: windows that pitch further are left out [rad].
constexpr double kSteepest = 60.0 * kDegree;

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

/// Mean over a window of a matrix that is known at each moment of the grid; NaN where it is missing somewhere.
template <typename AtMoment>
auto mean_over(const Window& window, const numerics::UniformGrid& grid, const AtMoment& at_moment) {
  using Value = std::invoke_result_t<AtMoment, std::size_t>;
  Value sum = Value::Zero();
  const double h = grid.step;
  const auto first = static_cast<std::size_t>(std::max(0.0, std::floor((window.begin - grid.begin) / h)));
  for (std::size_t k = first; k < grid.count && grid.at(k) - 0.5 * h < window.end; ++k) {
    const double overlap = std::min(window.end, grid.at(k) + 0.5 * h) - std::max(window.begin, grid.at(k) - 0.5 * h);
    if (overlap > 0.0) sum += overlap * at_moment(k);
  }
  return Value(sum / (window.end - window.begin));
}

/// Variance that the white noise of three channels gives the mean rate of change over a window, mean of the three.
double change_noise(std::initializer_list<const Channel*> channels, double length_s) {
  double variance = 0.0;
  for (const Channel* channel : channels) variance += 2.0 * std::pow(noise_floor(*channel) / length_s, 2.0) / 3.0;
  return variance;
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
  Equations::Delays delays = Equations::Delays::Zero();
  delays.col(0) = (change - turning) / T;
  delays.col(1).head<2>() = -change.head<2>() / T;
  delays(2, 2) = -change(2) / T;
  return delays;
}

/// What only the velocity says, all but `gyro`, with the velocity taken as `late_s` late and the gain of an axis that
/// is not in `moved` as 1.
InertialConsistency compare_velocity(const Recording& recording, const InertialSeries& s,
                                     std::span<const TimeSpan> spans, double late_s,
                                     const std::array<bool, 3>& moved = {true, true, true}) {
  InertialConsistency out;
  const Channel& north = recording.at("vel_north");
  const Channel& east = recording.at("vel_east");
  const Channel& down = recording.at("vel_down");
  if (east.size() != north.size() || down.size() != north.size()) return out;
  std::vector<double> stamps(north.times().begin(), north.times().end());
  for (double& t : stamps) t -= late_s;
  const Vector3 gravity(0.0, 0.0, kGravity);
  Equations by_force(change_noise({&north, &east, &down}, kVelocityWindow_s)), by_velocity(kInfinity);
  for (const Window& window : windows(stamps, spans, kVelocityWindow_s, kVelocityHop_s)) {
    const auto v = [&](std::size_t i) { return Vector3(north.value[i], east.value[i], down.value[i]); };
    const Vector3 acceleration = (v(window.last) - v(window.first)) / (window.end - window.begin);
    // Regressors, and what an error of the heading adds: north of the attitude is not that of the velocity by magnetic
    // declination, iron on board, or a compass that was not turned.
    const auto means = mean_over(window, s.grid, [&](std::size_t k) {
      const Matrix3 R = ned_from_body(s, k);
      const Vector3 f = R * s.f(k), turned(f(1), -f(0), 0.0);
      Eigen::Matrix<double, 3, kUnknowns + 3> both;
      both << regressors(R, s.f(k)), turned * Eigen::RowVector3d(1.0, std::sin(s.angle[2][k]), std::cos(s.angle[2][k]));
      return both;
    });
    const Eigen::Matrix<double, 3, kUnknowns> X = means.leftCols<kUnknowns>();
    Equations::Delays delays = delays_over(s, window);
    delays.rightCols<3>() = means.rightCols<3>();
    by_force.add(X, acceleration - gravity, delays);
    // Columns of the unit gain: what the accelerometer says as it is.
    const Vector3 said = X.col(0) + X.col(4) + X.col(8) + gravity;
    // A velocity that is turned as a whole is what its gains are to show.
    delays.rightCols<3>().setZero();
    by_velocity.add(regressors(Matrix3::Identity(), acceleration), said, -delays);
  }
  if (const std::optional<Solved> force = by_force.solve(true, moved)) {
    out.accelerometer = force->matrix;
    out.accelerometer_delay = force->delay(0);
    out.accelerometer_delay_sigma = force->delay_sigma(0);
    out.velocity_delay = late_s + force->delay(1);
    out.velocity_delay_sigma = force->delay_sigma(1);
    out.vertical_delay = late_s + force->delay(2);
    out.vertical_delay_sigma = force->delay_sigma(2);
  }
  if (std::optional<Solved> velocity = by_velocity.solve(true)) out.velocity = velocity->matrix;
  return out;
}

SensorNames accelerometer_names() {
  return {"accelerometer",    "velocity and attitude",   {"x", "y", "z"},
          Check::kSensorGain, Check::kAccelerometerBias, 1.0,
          parse_unit("m/s^2")};
}

/// A filter that smooths down takes from its fluctuations what a scale of the accelerometer, and a bias by which it
/// reads gravity all the same, would. One that is right with a z of unit gain is right, and of that gain nothing is
/// known.
void leave_to_filter_of_down(InertialConsistency& found, const InertialConsistency& with_unit_z) {
  if (!with_unit_z.accelerometer) return;
  const std::vector<Evidence> rows = sensor_matrix_evidence(*with_unit_z.accelerometer, accelerometer_names());
  if (!std::ranges::all_of(rows, &Evidence::passed)) return;
  found.accelerometer = with_unit_z.accelerometer;
  found.velocity.reset();
}

/// The same with the velocity shifted by the delay that is found, which is linear only where it is small.
InertialConsistency compare_velocity(const Recording& recording, const InertialSeries& s,
                                     std::span<const TimeSpan> spans) {
  constexpr int kMostSteps = 4;
  constexpr double kSmall_s = 0.03, kLargest_s = 2.0;
  const auto conspicuous = [&](double delay_s, double sigma_s) {
    return std::abs(delay_s) >= std::max(kSmall_s, estimation::kBeyondChance * sigma_s);
  };
  InertialConsistency out = compare_velocity(recording, s, spans, 0.0);
  double late_s = 0.0;
  for (int step = 0; step < kMostSteps && out.accelerometer; ++step) {
    const double more = out.velocity_delay - late_s;
    if (!conspicuous(more, out.velocity_delay_sigma)) break;
    late_s += more;
    if (!(std::abs(late_s) < kLargest_s)) break;
    InertialConsistency shifted = compare_velocity(recording, s, spans, late_s);
    if (!shifted.accelerometer || !(shifted.accelerometer->unexplained() < out.accelerometer->unexplained())) break;
    out = std::move(shifted);
  }
  if (!out.accelerometer) return out;
  // Down comes later than north and east, or shows less than the accelerometer.
  const double lag_s = out.vertical_delay - out.velocity_delay;
  const double more = out.accelerometer->gain(2, 2) - 1.0;
  if ((lag_s > 0.0 && conspicuous(lag_s, out.vertical_delay_sigma)) ||
      more > estimation::kBeyondChance * out.accelerometer->gain_sigma(2, 2))
    leave_to_filter_of_down(out, compare_velocity(recording, s, spans, out.velocity_delay, {true, true, false}));
  return out;
}

std::optional<SensorMatrix> compare_rates(const Recording& recording, const InertialSeries& s,
                                          std::span<const TimeSpan> spans) {
  const std::vector<double> stamps(recording.at("roll").times().begin(), recording.at("roll").times().end());
  // An attitude's errors are not white (it is an estimate itself), and a gyro's noise is small over a window: all that
  // is left unexplained is taken for the attitude's.
  Equations equations(kInfinity);
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
  const std::optional<Solved> solved = equations.solve(false);
  return solved ? std::optional(solved->matrix) : std::nullopt;
}

Evidence delay_row(Check check, const char* about, double delay_s, double sigma_s, Cause cause) {
  Evidence row = estimation::row_of(check, about, delay_s, sigma_s);
  if (!row.passed()) row.cause = cause;
  return std::move(row).with("size", std::abs(delay_s)).with("way", delay_s < 0.0 ? "before" : "behind");
}

/// The delay of the velocity, or of down, where only that is conspicuous.
Evidence velocity_delay_row(const InertialConsistency& c) {
  const Evidence level =
      delay_row(Check::kVelocityDelay, "ground velocity", c.velocity_delay, c.velocity_delay_sigma, Cause::kDelay);
  const Evidence down =
      delay_row(Check::kVelocityDelay, "ground velocity", c.vertical_delay, c.vertical_delay_sigma, Cause::kLag);
  return down.outcome > level.outcome ? down : level;
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
  const SensorNames force = accelerometer_names();
  const SensorNames velocity{"ground velocity",  "accelerometer and attitude", {"north", "east", "down"},
                             Check::kSensorGain, Check::kVelocityBias,         1.0,
                             parse_unit("m/s")};
  const SensorNames rate{"gyro",           "the attitude", {"x", "y", "z"},    Check::kSensorGain,
                         Check::kGyroBias, kDegree,        parse_unit("rad/s")};
  const double failed = estimation::info_of(Check::kSensorGain).tolerance.highest;
  std::vector<Evidence> rows;
  const auto add = [&](const SensorMatrix& matrix, const SensorNames& names) {
    std::vector<Evidence> of_sensor = sensor_matrix_evidence(matrix, names);
    std::ranges::move(of_sensor, std::back_inserter(rows));
    return std::ranges::any_of(rows.end() - signed_index(of_sensor.size()), rows.end(),
                               [](const Evidence& row) { return row.outcome == Outcome::kFailed; });
  };
  bool force_failed = false, rate_failed = false;
  if (c.accelerometer) {
    // The same contradiction read the other way: a wrong velocity leaves less unexplained than a wrong accelerometer,
    // and without a bias: the derivative of a velocity has none, while a wrong specific force shows gravity as one.
    constexpr double kClearlyBetter = 0.7;
    // Where the gyro contradicts the attitude too, the attitude is the suspect.
    const bool attitude_holds = !c.gyro || !gain_fault(*c.gyro, rate, failed);
    const bool rather_velocity =
        attitude_holds && c.velocity && gain_fault(*c.velocity, velocity, failed) &&
        c.velocity->bias.cwiseAbs().maxCoeff() < estimation::info_of(Check::kVelocityBias).tolerance.highest &&
        c.velocity->unexplained() < kClearlyBetter * c.accelerometer->unexplained();
    if (rather_velocity)
      add(*c.velocity, velocity);
    else
      force_failed = add(*c.accelerometer, force);
  }
  if (c.gyro) rate_failed = add(*c.gyro, rate);
  if (c.accelerometer_delay) {
    rows.push_back(delay_row(Check::kAccelerometerDelay, "accelerometer", *c.accelerometer_delay,
                             c.accelerometer_delay_sigma, Cause::kDelay));
    rows.push_back(velocity_delay_row(c));
  }
  if (rate_failed && force_failed) {
    Evidence row = estimation::row_of(Check::kAttitude, "attitude", Outcome::kFailed);
    row.cause = Cause::kAxis;
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace veridyn::recording
