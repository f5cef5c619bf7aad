#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "veridyn/aircraft/identification/budget/sensor_error.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/core/study_keys.hpp"

namespace veridyn::aircraft {

/// How well attitude and heading of an ordinary autopilot are known in the mean [rad]: zeros of vanes and of the
/// accelerometer are measured against them.
inline constexpr double kAttitudeZero = 0.5 * kDegree, kHeadingZero = 2.0 * kDegree;

/// A line of the table `sensor_priors.inc`.
struct SensorPrior {
  BudgetSensor sensor;
  SensorErrorKind kind;
  double sigma;
  std::string_view unit;
  std::string_view source;
};

/// All lines: what is taken of sensors of which a study says nothing.
[[nodiscard]] std::span<const SensorPrior> sensor_priors();

/// What a study knows of a real sensor, in the tables `[sensors.airspeed]`, `[sensors.alpha]`, ...
struct KnownSensors {
  std::vector<SensorError> errors = {};  ///< in place of the lines of the table

  [[nodiscard]] const SensorError* find(BudgetSensor sensor, SensorErrorKind kind) const;
};

/// Keys of one such table: `scale`, `zero` and `delay`, each `{ value, sigma }`.
[[nodiscard]] const KeyTable<KnownSensors>& known_sensor_keys();
/// Reads the tables of known sensors in `[sensors]`; those of simulated sensors have other names.
/// @throws InputError for a plain number: it would be the error of a simulated sensor
[[nodiscard]] KnownSensors read_known_sensors(const StudyTable& sensors);

/// The prior of one error: what the study knows, else the table's.
[[nodiscard]] SensorError prior_of(BudgetSensor sensor, SensorErrorKind kind, const KnownSensors& known);

/// A normal prior after an independent measurement of the error, `value` +- `sigma`; the prior where that is NaN.
[[nodiscard]] SensorError updated(SensorError prior, double value, double sigma);

}  // namespace veridyn::aircraft
