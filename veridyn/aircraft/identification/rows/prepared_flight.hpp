#pragma once

#include <string>
#include <vector>

#include "veridyn/aircraft/identification/budget/sensor_error.hpp"
#include "veridyn/aircraft/identification/evidence/checked_flight.hpp"
#include "veridyn/aircraft/identification/signals/flight_signals.hpp"
#include "veridyn/aircraft/identification/signals/segments.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct.hpp"
#include "veridyn/aircraft/sensors/delays.hpp"

namespace veridyn::aircraft {

/// A flight made ready for identification by itself: sensors on one clock, motion through its own wind, signals,
/// segments. Coefficients are identified from one or several of these.
struct PreparedFlight {
  std::string name = {};  ///< of its recording, where a study has several; empty where it is the only one
  /// Added to its times on the axis on which figures and tables show several flights one after the other [s].
  double shift_s = 0.0;
  MappedRecording aligned = {};  ///< the recording with the delays taken off
  std::vector<DelayReport> delays = {};
  Reconstruction reconstruction = {};
  FlightSignals signals = {};
  Segments segments = {};
  std::vector<estimation::Evidence> recording_evidence =
      {};                    ///< does the recording agree with itself and with physics?
  SensorBudget budget = {};  ///< errors of its sensors; the signals are without their means

  /// Whether its motion is known: of a contradicted flight there are neither signals nor excited segments.
  [[nodiscard]] bool usable() const { return !reconstruction.contradiction; }
};

}  // namespace veridyn::aircraft
