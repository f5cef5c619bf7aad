#include "veridyn/aircraft/sensors/air_data_consistency.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "veridyn/aircraft/model/still_air_rate.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/index.hpp"
#include "veridyn/core/rank.hpp"
#include "veridyn/estimation/regression/instrumental_variables.hpp"
#include "veridyn/numerics/rotation.hpp"
#include "veridyn/numerics/statistics.hpp"
#include "veridyn/recording/grid_signals.hpp"

namespace veridyn::aircraft {
namespace {

using estimation::RegressionData;
using Vector3 = numerics::Vector3<double>;

constexpr double kRowInterval_s = 0.5;
constexpr double kStandardDensity = 1.225;
constexpr std::size_t kFewestRows = 60;
constexpr double kLocalWind_s = 30.0;
/// Standard error of the scale from which on it is not distinguishable from the wind by the headings.
constexpr double kDeterminedScale = 0.05;
/// Gusts are correlated over seconds: lags of half a minute [moments].
constexpr Eigen::Index kLongestLag = 60;

/// Means over half a second; NaN where a channel has a hole.
struct AirDataRows {
  std::vector<int> segment;
  std::vector<Vector3> velocity, attitude;
  std::vector<double> airspeed, alpha, beta;
  [[nodiscard]] std::size_t size() const { return segment.size(); }
};

std::vector<double> channel_on(const Recording& recording, const char* name, const numerics::UniformGrid& grid) {
  if (!recording.has(name) || recording.at(name).size() < 2) return {};
  return recording::on_grid(recording.at(name), grid, recording::Holes::kOfHalfASecond,
                            numerics::Interpolation::kLinear);
}

std::vector<double> airspeed_on(const Recording& recording, const Channel& air_density, bool airspeed_is_true,
                                const numerics::UniformGrid& grid) {
  const std::vector<double> density = recording::on_grid(air_density, grid);
  const bool by_pressure = recording.has("dynamic_pressure");
  std::vector<double> speed = channel_on(recording, by_pressure ? "dynamic_pressure" : "airspeed", grid);
  for (std::size_t k = 0; k < speed.size(); ++k) {
    if (by_pressure)
      speed[k] = std::sqrt(2.0 * std::max(0.0, speed[k]) / density[k]);
    else if (!airspeed_is_true)
      speed[k] *= std::sqrt(kStandardDensity / density[k]);
  }
  return speed;
}

AirDataRows rows_of(const Recording& recording, const Channel& air_density, bool airspeed_is_true,
                    std::span<const TimeSpan> spans) {
  const Channel& clock = recording.at("roll");
  const double rate = recording::grid_rate(clock);
  const numerics::UniformGrid grid = recording::grid_over(clock, rate, recording.source);
  const std::array<std::vector<double>, 3> velocity{channel_on(recording, "vel_north", grid),
                                                    channel_on(recording, "vel_east", grid),
                                                    channel_on(recording, "vel_down", grid)};
  const std::array<std::vector<double>, 3> attitude{recording::angle_on_grid(recording.at("roll"), grid),
                                                    recording::angle_on_grid(recording.at("pitch"), grid),
                                                    recording::angle_on_grid(recording.at("yaw"), grid)};
  const std::vector<double> airspeed = airspeed_on(recording, air_density, airspeed_is_true, grid),
                            alpha = channel_on(recording, "alpha", grid), beta = channel_on(recording, "beta", grid);
  const auto block = static_cast<std::size_t>(std::max(1.0, std::round(kRowInterval_s * rate)));
  AirDataRows rows;
  int segment = 0;
  for (const TimeSpan& span : spans) {
    const auto [begin, end] = recording::grid_indices(grid, span);
    for (std::size_t k = begin; k + block <= end; k += block) {
      const auto mean = [&](const std::vector<double>& v) {
        if (v.empty()) return kNaN;
        double sum = 0.0;
        for (std::size_t i = k; i < k + block; ++i) sum += v[i];
        return sum / static_cast<double>(block);
      };
      rows.segment.push_back(segment);
      rows.velocity.emplace_back(mean(velocity[0]), mean(velocity[1]), mean(velocity[2]));
      rows.attitude.emplace_back(mean(attitude[0]), mean(attitude[1]), mean(attitude[2]));
      rows.airspeed.push_back(mean(airspeed));
      rows.alpha.push_back(mean(alpha));
      rows.beta.push_back(mean(beta));
    }
    ++segment;
  }
  return rows;
}

/// Regressors and instruments side by side, so that rows with a hole leave both.
estimation::InstrumentalEstimate solve(RegressionData data, Eigen::Index regressors, Eigen::Index rows_a_moment = 1) {
  data.parameter_names.clear();
  estimation::drop_rows_that_are_not_finite(data);
  if (data.rows() < signed_index(kFewestRows)) return {};
  const estimation::RowMatrix both = data.regressors;
  data.regressors = both.leftCols(regressors);
  return estimation::instrumental_variables(data, both.rightCols(both.cols() - regressors),
                                            rows_a_moment * kLongestLag);
}

Determined of(const estimation::InstrumentalEstimate& estimate, Eigen::Index i) {
  // Three of these standard errors are as rare as three of a normal distribution, however few gusts there were.
  constexpr double kThreeSigma = 0.99865;
  const double factor = numerics::student_t_quantile(kThreeSigma, std::max(3.0, estimate.degrees_of_freedom)) / 3.0;
  return {estimate.theta(i), factor * std::sqrt(estimate.covariance(i, i))};
}

/// Horizontal part of the airspeed at a sink rate; NaN without airspeed.
double level_airspeed(double airspeed, double down) {
  return std::isfinite(airspeed) ? std::sqrt(std::max(0.0, airspeed * airspeed - down * down)) : kNaN;
}

/// Scale of the airspeed and mean wind together; nothing else is set. The ground velocity drifts with slow gusts, the
/// heading does not: it is the instrument.
AirDataConsistency scale_and_wind(const AirDataRows& rows) {
  AirDataConsistency out;
  const auto n = signed_index(rows.size());
  RegressionData data;
  data.regressors = estimation::RowMatrix::Zero(2 * n, 6);
  data.regressand.resize(2 * n);
  // North and east of a moment side by side: a gust is in both.
  for (Eigen::Index k = 0; k < n; ++k) {
    const Vector3& v = rows.velocity[k];
    const double yaw = rows.attitude[k](2);
    const double level = level_airspeed(rows.airspeed[k], v(2));
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const double heading = axis == 0 ? std::cos(yaw) : std::sin(yaw);
      const Eigen::Index row = 2 * k + axis;
      data.regressand(row) = level * heading;
      data.regressors(row, 0) = v(axis);
      data.regressors(row, 1 + axis) = 1.0;
      data.regressors(row, 3) = heading;
      data.regressors(row, 4 + axis) = 1.0;
      data.segment.push_back(rows.segment[k]);
    }
  }
  const estimation::InstrumentalEstimate estimate = solve(std::move(data), 3, 2);
  if (!estimate.usable) return out;
  out.airspeed_scale = of(estimate, 0);
  // Where scale and wind are not distinguishable by the headings, the scale is taken as right.
  const double scale = out.airspeed_scale->sigma < kDeterminedScale ? out.airspeed_scale->value : 1.0;
  for (Eigen::Index i = 0; i < 2; ++i) {
    out.wind(i) = -estimate.theta(1 + i) / scale;
    out.wind_sigma(i) = of(estimate, 1 + i).sigma / scale;
  }
  return out;
}

/// Ground velocity less airspeed along the heading, averaged over half a minute: a steady wind and slow gusts. Sideslip
/// is taken to average out.
std::vector<Vector3> local_wind(const AirDataRows& rows, double scale) {
  const auto half = static_cast<std::size_t>(kLocalWind_s / (2.0 * kRowInterval_s));
  std::vector<Vector3> difference(rows.size()), wind(rows.size(), Vector3::Constant(kNaN));
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Vector3& v = rows.velocity[k];
    const double Va = rows.airspeed[k] / scale, yaw = rows.attitude[k](2);
    const double level = level_airspeed(Va, v(2));
    difference[k] = v - Vector3(level * std::cos(yaw), level * std::sin(yaw), v(2));
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    Vector3 sum = Vector3::Zero();
    std::size_t count = 0;
    const std::size_t first = k > half ? k - half : 0, last = std::min(rows.size() - 1, k + half);
    for (std::size_t i = first; i <= last; ++i) {
      if (rows.segment[i] != rows.segment[k] || !difference[i].allFinite()) continue;
      sum += difference[i];
      ++count;
    }
    if (count > half) wind[k] = sum / static_cast<double>(count);
  }
  return wind;
}

/// All but the largest thousandth are below it.
double largest_of(std::vector<double> values) {
  return value_of_rank(values, static_cast<std::size_t>(0.999 * static_cast<double>(values.size() - 1)));
}

/// Mean of what is finite, with the error of a mean of correlated samples.
Determined mean_of(const std::vector<double>& values, const std::vector<int>& segment) {
  RegressionData data;
  data.regressors = estimation::RowMatrix::Ones(values.size(), 2);
  data.regressand = Eigen::Map<const Eigen::VectorXd>(values.data(), signed_index(values.size()));
  data.segment = segment;
  const estimation::InstrumentalEstimate estimate = solve(std::move(data), 1);
  return estimate.usable ? of(estimate, 0) : Determined{kNaN, kNaN};
}

/// The vane against the inertial angle in the mean.
std::optional<VaneFit> fit_vane(const AirDataRows& rows, const std::vector<double>& reading,
                                const std::vector<double>& inertial) {
  std::vector<double> sizes, difference(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    difference[k] = reading[k] - inertial[k];
    if (std::isfinite(reading[k])) sizes.push_back(std::abs(reading[k]));
  }
  if (sizes.size() < kFewestRows) return std::nullopt;
  return VaneFit{.bias = mean_of(difference, rows.segment), .largest_reading = largest_of(std::move(sizes))};
}

/// Length of a change, and from one to the next [s].
constexpr double kChange_s = 0.25;
constexpr double kChangeHop_s = 0.05;
/// Least share of the angle's changes that the controls must make.
constexpr double kLeastRelevance = 0.02;

/// A control that moves less is none, as the rudder of a flying wing [rad].
constexpr double kLeastThrow = 0.2 * kDegree;

/// Angle of the flow by gyro, accelerometer and attitude, but for a constant: integrals of alpha' and beta'.
struct InertialAngles {
  numerics::UniformGrid grid;
  std::vector<double> alpha, beta;
};

/// Mean over half a second, for what only enters through small products.
std::vector<double> smoothed(const std::vector<double>& x, double rate_Hz) {
  const auto half = static_cast<std::size_t>(std::max(1.0, 0.25 * rate_Hz));
  std::vector<double> sum(x.size() + 1, 0.0);
  for (std::size_t k = 0; k < x.size(); ++k) sum[k + 1] = sum[k] + (std::isfinite(x[k]) ? x[k] : 0.0);
  std::vector<double> mean(x.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    const std::size_t first = k > half ? k - half : 0, last = std::min(x.size(), k + half + 1);
    mean[k] = (sum[last] - sum[first]) / static_cast<double>(last - first);
  }
  return mean;
}

InertialAngles inertial_angles(const Recording& recording, const Channel& air_density, bool airspeed_is_true) {
  const Channel& clock = recording.at("gyro_x");
  const double rate = recording::grid_rate(clock);
  InertialAngles out{.grid = recording::grid_over(clock, rate, recording.source), .alpha = {}, .beta = {}};
  const auto on_grid = [&](const char* name) { return channel_on(recording, name, out.grid); };
  const auto flow = [&](const char* name) {
    return recording.has(name) ? smoothed(on_grid(name), rate) : std::vector<double>(out.grid.count, 0.0);
  };
  const std::vector<double> p = on_grid("gyro_x"), q = on_grid("gyro_y"), r = on_grid("gyro_z"),
                            ax = on_grid("accel_x"), ay = on_grid("accel_y"), az = on_grid("accel_z"),
                            V = smoothed(airspeed_on(recording, air_density, airspeed_is_true, out.grid), rate),
                            a = flow("alpha"), b = flow("beta"),
                            roll = recording::angle_on_grid(recording.at("roll"), out.grid),
                            pitch = recording::angle_on_grid(recording.at("pitch"), out.grid);
  out.alpha.assign(out.grid.count, 0.0);
  out.beta.assign(out.grid.count, 0.0);
  for (std::size_t k = 1; k < out.grid.count; ++k) {
    const WindAxesRate<double> rate_now = still_air_rate({.specific_force = {ax[k], ay[k], az[k]},
                                                          .rates = {p[k], q[k], r[k]},
                                                          .phi = roll[k],
                                                          .theta = pitch[k],
                                                          .Va = V[k],
                                                          .alpha = a[k],
                                                          .beta = b[k]});
    const double h = out.grid.step;
    // After a hole the integrals restart from zero: holes are longer than kChange_s, so no change spans one.
    const auto from = [](double last) { return std::isfinite(last) ? last : 0.0; };
    out.alpha[k] = from(out.alpha[k - 1]) + h * rate_now.alpha;
    out.beta[k] = from(out.beta[k - 1]) + h * rate_now.beta;
  }
  return out;
}

std::optional<VaneSlope> slope_of(const Recording& recording, const char* vane,
                                  std::initializer_list<const char*> controls, const numerics::UniformGrid& grid,
                                  const std::vector<double>& angle, std::span<const TimeSpan> manoeuvres) {
  const std::vector<double> reading = channel_on(recording, vane, grid);
  std::vector<std::vector<double>> moved;
  for (const char* name : controls) {
    if (!recording.has(name)) continue;
    std::vector<double> control = channel_on(recording, name, grid);
    const auto [low, high] = std::ranges::minmax(recording.at(name).value);
    if (high - low > kLeastThrow) moved.push_back(std::move(control));
  }
  const auto n = static_cast<std::size_t>(std::max(2.0, std::round(kChange_s / grid.step)));
  const auto hop = static_cast<std::size_t>(std::max(1.0, std::round(kChangeHop_s / grid.step)));
  // The angle answers a control for three quarters of a second: with less of it x8's slope was known to 0.21, not 0.15.
  constexpr std::size_t kLags = 6;
  const std::size_t lag_step = std::max<std::size_t>(1, n / 2);
  const std::size_t reach = (kLags - 1) * lag_step + n;
  std::vector<std::size_t> rows;
  RegressionData data;
  int segment = 0;
  for (const TimeSpan& span : manoeuvres) {
    const auto [begin, end] = recording::grid_indices(grid, span);
    for (std::size_t k = std::max(begin, reach); k < end; k += hop) {
      rows.push_back(k);
      data.segment.push_back(segment);
    }
    ++segment;
  }
  const auto count = signed_index(rows.size());
  const auto instruments = signed_index(kLags * moved.size()) + 1;
  if (moved.empty() || count < 10 * instruments) return std::nullopt;
  data.regressors = estimation::RowMatrix::Ones(count, 2 + instruments);
  data.regressand.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::size_t k = rows[i];
    data.regressand(i) = reading[k] - reading[k - n];
    data.regressors(i, 0) = angle[k] - angle[k - n];
    Eigen::Index column = 2;
    for (const std::vector<double>& control : moved)
      for (std::size_t lag = 0; lag < kLags; ++lag) {
        const std::size_t then = k - lag * lag_step;
        data.regressors(i, column++) = control[then] - control[then - n];
      }
  }
  const estimation::InstrumentalEstimate estimate = solve(std::move(data), 2);
  if (!estimate.usable || !(estimate.relevance(0) > kLeastRelevance)) return std::nullopt;
  return VaneSlope{.slope = of(estimate, 0), .relevance = estimate.relevance(0)};
}

bool has_inertial(const Recording& recording) {
  for (const char* name : {"gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z", "roll", "pitch"})
    if (!recording.has(name) || recording.at(name).size() < 2) return false;
  return recording.has("dynamic_pressure") || recording.has("airspeed");
}

}  // namespace

std::optional<VaneSlope> alpha_slope(const Recording& recording, const Channel& air_density, bool airspeed_is_true,
                                     std::span<const TimeSpan> manoeuvres) {
  if (!has_inertial(recording) || !recording.has("alpha")) return std::nullopt;
  const InertialAngles angles = inertial_angles(recording, air_density, airspeed_is_true);
  return slope_of(recording, "alpha", {"elevator"}, angles.grid, angles.alpha, manoeuvres);
}

std::optional<VaneSlope> beta_slope(const Recording& recording, const Channel& air_density, bool airspeed_is_true,
                                    std::span<const TimeSpan> manoeuvres) {
  if (!has_inertial(recording) || !recording.has("beta")) return std::nullopt;
  const InertialAngles angles = inertial_angles(recording, air_density, airspeed_is_true);
  return slope_of(recording, "beta", {"rudder", "aileron"}, angles.grid, angles.beta, manoeuvres);
}

AirDataConsistency air_data_consistency(const Recording& recording, const Channel& air_density, bool airspeed_is_true,
                                        std::span<const TimeSpan> airborne) {
  for (const char* name : {"roll", "pitch", "yaw", "vel_north", "vel_east", "vel_down"})
    if (!recording.has(name) || recording.at(name).size() < 2) return {};
  const AirDataRows rows = rows_of(recording, air_density, airspeed_is_true, airborne);
  if (rows.size() < kFewestRows) return {};
  AirDataConsistency out = scale_and_wind(rows);
  if (!out.airspeed_scale) return out;
  const double scale = out.airspeed_scale->sigma < kDeterminedScale ? out.airspeed_scale->value : 1.0;
  const std::vector<Vector3> wind = local_wind(rows, scale);
  std::vector<double> alpha(rows.size()), beta(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Vector3& e = rows.attitude[k];
    const Vector3 air = numerics::R_body_from_ned(e(0), e(1), e(2)) * (rows.velocity[k] - wind[k]);
    alpha[k] = std::atan2(air(2), air(0));
    beta[k] = std::asin(std::clamp(air(1) / std::max(air.norm(), 1e-3), -1.0, 1.0));
  }
  if (recording.has("alpha")) out.alpha = fit_vane(rows, rows.alpha, alpha);
  if (recording.has("beta")) out.beta = fit_vane(rows, rows.beta, beta);
  return out;
}

}  // namespace veridyn::aircraft
