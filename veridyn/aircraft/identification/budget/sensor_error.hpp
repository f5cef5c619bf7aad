#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "veridyn/aircraft/identification/signals/flight_signals.hpp"
#include "veridyn/aircraft/sensors/sensors.hpp"
#include "veridyn/core/enum_array.hpp"

/// Errors of sensors that are the same in all samples of a flight: they do not average out and show in no residual.
/// Each is an unknown with a prior (`sensor_priors.hpp`), which the checks of the recording update; its mean is taken
/// off the signals before the regression, and its covariance widens the intervals of the parameters.
namespace veridyn::aircraft {

/// Whose error it is. That of the air: it does more than to move as a whole.
enum class BudgetSensor { kAirspeed, kAlpha, kBeta, kElevator, kAileron, kRudder, kAccelerometer, kAirDensity, kAir };
inline constexpr std::size_t kBudgetSensors = 9;  ///< values of BudgetSensor
/// As in studies, `[sensors.alpha]`.
inline constexpr EnumArray<BudgetSensor, std::string_view, kBudgetSensors> kBudgetSensorNames{kRecordedSensorNames};

enum class SensorErrorKind {
  kScale,  ///< of reading over truth, less 1
  kZero,   ///< of the reading, in the signal's unit
  kDelay,  ///< from event to stamp, against the gyro [s]
  kLag,    ///< of a surface behind a first-order lag of what is recorded of it [s]
  kZeroX,  ///< of one axis of the accelerometer [m/s^2]
  kZeroY,
  kZeroZ,
  kPlaceX,  ///< of the accelerometer, from where it is taken to be, along a body axis [m]
  kPlaceY,
  kPlaceZ,
  kGustRoll,   ///< of the rate p_g that gusts give the air across the span, share of the variance of MIL-F-8785C's
  kGustPitch,  ///< of the rate q_g that they give it along the aircraft, share of MIL-F-8785C's
  kGustYaw,    ///< likewise of r_g
  kDownwash    ///< of the parameters by q: the part that is the downwash's, which comes late
};
inline constexpr std::size_t kSensorErrorKinds = 14;  ///< values of SensorErrorKind
/// As in studies.
inline constexpr EnumArray<SensorErrorKind, std::string_view, kSensorErrorKinds> kSensorErrorKindNames{
    {"scale", "zero", "delay", "lag", "zero_x", "zero_y", "zero_z", "place_x", "place_y", "place_z", "gust_roll",
     "gust_pitch", "gust_yaw", "downwash"}};
/// What it is, in words.
inline constexpr EnumArray<SensorErrorKind, std::string_view, kSensorErrorKinds> kSensorErrorKindMeanings{
    {"reading over truth", "reading less truth; of the airspeed in its pressure", "from event to time stamp",
     "time constant with which the surface follows what is recorded; 0 where its position is",
     "reading less truth along the body's x", "likewise along y", "likewise along z",
     "where it is, less where `imu_position` says, along the body's x", "likewise along y", "likewise along z",
     "share of the variance of the p_g that MIL-F-8785C gives gusts across the span",
     "share of the q_g that it gives gusts along the aircraft", "likewise of r_g",
     "part of the parameters by q that is the downwash's and comes late"}};

/// The signals that a sensor measures; none of the air density, which is no `FlightSignal`.
[[nodiscard]] std::span<const FlightSignal> signals_of(BudgetSensor sensor);

/// One unknown: what it is thought to be, with one standard deviation.
struct SensorError {
  BudgetSensor sensor = BudgetSensor::kAirspeed;
  SensorErrorKind kind = SensorErrorKind::kScale;
  double mean = 0.0;
  double sigma = 0.0;
};

/// The errors of a flight's sensors after everything that its recording says of them.
struct SensorBudget {
  std::vector<SensorError> errors;  ///< their means have been taken off the signals
  Eigen::MatrixXd covariance;       ///< of the errors, in their order

  /// Adds errors that are independent of those before and of each other.
  void add(const std::vector<SensorError>& independent);
  /// Adds errors with a covariance of their own.
  void add(const std::vector<SensorError>& more, const Eigen::MatrixXd& covariance_of_more);
};

/// Each kind of error of each sensor has a place among all: columns of sensitivities.
inline constexpr std::size_t kSensorErrors = kSensorErrorKinds * kBudgetSensors;
[[nodiscard]] constexpr std::size_t place_of(const SensorError& error) {
  return kSensorErrorKinds * static_cast<std::size_t>(error.sensor) + static_cast<std::size_t>(error.kind);
}

/// The symmetric root of the correlation of the errors, 0 for those that are known exactly: sensitivities per standard
/// deviation times it are those of independent unknowns.
[[nodiscard]] Eigen::MatrixXd root_of_correlation(const SensorBudget& budget);

/// Whether a coefficient's rows hold a sensor. Delays of the accelerometer are against the gyro: moments have none.
[[nodiscard]] bool rests_on(Coefficient coefficient, BudgetSensor sensor);

/// The signals with one more error of the size given, in the unit of its kind. A thrust that was computed from the
/// airspeed follows it, a deflection with a lag no longer jumps. Of a sensor that the flight does not have nothing
/// changes.
[[nodiscard]] FlightSignals with_error(FlightSignals signals, BudgetSensor sensor, SensorErrorKind kind, double size);

/// The signals without the means of the errors.
[[nodiscard]] FlightSignals without_errors(FlightSignals signals, const std::vector<SensorError>& errors);

}  // namespace veridyn::aircraft
