#include "veridyn/aircraft/identification/budget/sensor_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "veridyn/core/index.hpp"
#include "veridyn/numerics/linear_algebra/products.hpp"
#include "veridyn/numerics/linear_algebra/symmetric_eigen.hpp"
#include "veridyn/recording/lever_arm.hpp"

namespace veridyn::aircraft {
namespace {

using F = FlightSignal;

/// Of values on a grid `steps` later: by the cubic through the four nearest, the first and last value held beyond the
/// ends. The signals hold little above half of the grid's Nyquist frequency.
std::vector<double> later(const std::vector<double>& x, double steps) {
  const auto n = static_cast<std::ptrdiff_t>(x.size());
  std::vector<double> moved(x.size());
  const auto whole = static_cast<std::ptrdiff_t>(std::floor(-steps));
  const double u = -steps - static_cast<double>(whole);
  const std::array<double, 4> weight{-u * (u - 1.0) * (u - 2.0) / 6.0, (u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0,
                                     -(u + 1.0) * u * (u - 2.0) / 2.0, (u + 1.0) * u * (u - 1.0) / 6.0};
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    double sum = 0.0;
    for (std::ptrdiff_t i = 0; i < 4; ++i) {
      const std::ptrdiff_t at = std::clamp<std::ptrdiff_t>(k + whole + i - 1, 0, n - 1);
      sum += weight[static_cast<std::size_t>(i)] * x[static_cast<std::size_t>(at)];
    }
    moved[static_cast<std::size_t>(k)] = sum;
  }
  return moved;
}

/// Undoes a first-order lag: x + T x' for a time constant T > 0. For T < 0 it is x through a
/// lag of -T, exact where x is linear between grid points; the lag restarts after a gap.
std::vector<double> before_lag(const std::vector<double>& x, double time_constant, double step) {
  std::vector<double> y = x;
  if (time_constant > 0.0) {
    for (std::size_t k = 1; k + 1 < x.size(); ++k) y[k] += time_constant * (x[k + 1] - x[k - 1]) / (2.0 * step);
    return y;
  }
  if (time_constant == 0.0) return y;
  const double ratio = step / -time_constant, kept = std::exp(-ratio), mean = -std::expm1(-ratio) / ratio;
  for (std::size_t k = 1; k < x.size(); ++k) {
    if (!std::isfinite(x[k]) || !std::isfinite(y[k - 1])) continue;
    y[k] = kept * y[k - 1] + (mean - kept) * x[k - 1] + (1.0 - mean) * x[k];
  }
  return y;
}

void place_accelerometer(FlightSignals& signals, const Eigen::Vector3d& r) {
  if (!signals[F::kAx].available() || !signals[F::kAy].available() || !signals[F::kAz].available()) return;
  for (std::size_t k = 0; k < signals.grid.count; ++k) {
    const Eigen::Vector3d w(signals[F::kP].value[k], signals[F::kQ].value[k], signals[F::kR].value[k]);
    const Eigen::Vector3d dw(signals[F::kPdot].value[k], signals[F::kQdot].value[k], signals[F::kRdot].value[k]);
    const Eigen::Vector3d lever = recording::lever_arm_acceleration(dw, w, r);
    signals[F::kAx].value[k] += lever.x();
    signals[F::kAy].value[k] += lever.y();
    signals[F::kAz].value[k] += lever.z();
  }
}

/// Of an error of one of the accelerometer's axes; none of other errors.
std::optional<Eigen::Index> axis_of_error(SensorErrorKind kind, SensorErrorKind first) {
  const auto axis = static_cast<Eigen::Index>(kind) - static_cast<Eigen::Index>(first);
  return axis >= 0 && axis < 3 ? std::optional(axis) : std::nullopt;
}

}  // namespace

std::span<const F> signals_of(BudgetSensor sensor) {
  static constexpr std::array<F, 6> kOne{F::kAirspeed, F::kAlpha, F::kBeta, F::kElevator, F::kAileron, F::kRudder};
  static constexpr std::array<F, 3> kForce{F::kAx, F::kAy, F::kAz};
  switch (sensor) {
    case BudgetSensor::kAccelerometer:
      return kForce;
    case BudgetSensor::kAirDensity:
    case BudgetSensor::kAir:
      return {};
    default:
      return std::span(kOne).subspan(static_cast<std::size_t>(sensor), 1);
  }
}

void SensorBudget::add(const std::vector<SensorError>& independent) {
  Eigen::VectorXd variance(static_cast<Eigen::Index>(independent.size()));
  for (std::size_t i = 0; i < independent.size(); ++i)
    variance(static_cast<Eigen::Index>(i)) = independent[i].sigma * independent[i].sigma;
  add(independent, variance.asDiagonal());
}

void SensorBudget::add(const std::vector<SensorError>& more, const Eigen::MatrixXd& covariance_of_more) {
  errors.insert(errors.end(), more.begin(), more.end());
  const Eigen::Index before = covariance.rows(), count = covariance_of_more.rows();
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(before + count, before + count);
  whole.topLeftCorner(before, before) = covariance;
  whole.bottomRightCorner(count, count) = covariance_of_more;
  covariance = std::move(whole);
}

Eigen::MatrixXd root_of_correlation(const SensorBudget& budget) {
  const Eigen::VectorXd inverse =
      budget.covariance.diagonal().unaryExpr([](double v) { return v > 0.0 ? 1.0 / std::sqrt(v) : 0.0; });
  const numerics::SymmetricEigen axes =
      numerics::symmetric_eigen(numerics::scaled(inverse, budget.covariance, inverse));
  return numerics::from_eigen(axes.vectors, axes.values.cwiseMax(0.0).cwiseSqrt());
}

bool rests_on(Coefficient coefficient, BudgetSensor sensor) {
  const bool longitudinal =
      coefficient == Coefficient::kCL || coefficient == Coefficient::kCD || coefficient == Coefficient::kCm;
  const bool force =
      coefficient == Coefficient::kCL || coefficient == Coefficient::kCD || coefficient == Coefficient::kCY;
  switch (sensor) {
    case BudgetSensor::kAlpha:
    case BudgetSensor::kElevator:
      return longitudinal;
    case BudgetSensor::kBeta:
    case BudgetSensor::kAileron:
    case BudgetSensor::kRudder:
      return !longitudinal;
    case BudgetSensor::kAccelerometer:
      return force;
    default:
      return true;
  }
}

FlightSignals with_error(FlightSignals signals, BudgetSensor sensor, SensorErrorKind kind, double size) {
  if (sensor == BudgetSensor::kAir) {
    AirRates& air = signals.air_rates;
    // The share in the regressors is what is thought to be there: an error more is so much less of it.
    switch (kind) {
      case SensorErrorKind::kGustRoll:
        air.roll_share -= size;
        break;
      case SensorErrorKind::kGustPitch:
        air.pitch_share -= size;
        break;
      case SensorErrorKind::kGustYaw:
        air.yaw_share -= size;
        break;
      default:
        air.downwash_share -= size;
    }
    return signals;
  }
  if (sensor == BudgetSensor::kAirDensity) {
    for (double& rho : signals.air_density) rho *= 1.0 + size;
    return signals;
  }
  if (const auto axis = axis_of_error(kind, SensorErrorKind::kPlaceX)) {
    place_accelerometer(signals, size * Eigen::Vector3d::Unit(*axis));
    return signals;
  }
  if (const auto axis = axis_of_error(kind, SensorErrorKind::kZeroX)) {
    for (double& v : signals[signals_of(sensor)[at(*axis)]].value) v += size;
    return signals;
  }
  for (const F which : signals_of(sensor)) {
    std::vector<double>& value = signals[which].value;
    if (value.empty()) continue;
    const std::vector<double> before = value;
    if (kind == SensorErrorKind::kDelay) {
      value = later(before, size / signals.grid.step);
    } else if (kind == SensorErrorKind::kLag) {
      value = before_lag(before, size, signals.grid.step);
      std::erase_if(signals.jumps, [which](const DeflectionJump& jump) { return jump.control == which; });
    } else {
      for (double& v : value) v = kind == SensorErrorKind::kScale ? v * (1.0 + size) : v + size;
    }
    std::vector<double>& thrust = signals[F::kThrust].value;
    if (which != F::kAirspeed || signals.thrust_per_airspeed.empty()) continue;
    for (std::size_t k = 0; k < thrust.size(); ++k)
      thrust[k] += signals.thrust_per_airspeed[k] * (value[k] - before[k]);
  }
  return signals;
}

FlightSignals without_errors(FlightSignals signals, const std::vector<SensorError>& errors) {
  for (const SensorError& error : errors) {
    if (error.mean == 0.0) continue;
    const double size =
        error.kind == SensorErrorKind::kScale ? 1.0 / std::max(1.0 + error.mean, 0.1) - 1.0 : -error.mean;
    signals = with_error(std::move(signals), error.sensor, error.kind, size);
  }
  return signals;
}

}  // namespace veridyn::aircraft
