#pragma once

#include "veridyn/aircraft/aircraft_study.hpp"

namespace veridyn::aircraft::testing {

/// The study of a simulated flight whose sensors have noise and no other error, told so: for tests of estimators.
inline FlightStudy with_exact_sensors(FlightStudy study) {
  for (const SensorPrior& prior : sensor_priors())
    study.known_sensors.errors.push_back({.sensor = prior.sensor, .kind = prior.kind});
  study.delays.automatic = false;
  return study;
}

}  // namespace veridyn::aircraft::testing
