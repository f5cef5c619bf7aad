#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/aircraft/identification/options/open_loop_options.hpp"
#include "veridyn/aircraft/identification/rows/flight_rows.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/numerics/statistics.hpp"

namespace veridyn::aircraft {

/// Study table `[validate]`.
struct ValidationOptions {
  double period_s = 5.0;
  OpenLoopOptions open_loop = {};  ///< what is flown from deflections and thrust alone

  [[nodiscard]] static const KeyTable<ValidationOptions>& keys();
};

/// A quantity predicted by the model against what was measured.
struct PredictedQuantity {
  std::string name;  ///< "airspeed", "alpha", "beta"
  std::string unit;  ///< of the measures: m/s, deg
  numerics::FitMeasures fit = {};
  double last_value_rmse =
      0.0;  ///< of a prediction that holds the value at the start of each window; in the unit of the measures
  std::vector<double> time = {};       ///< [s]
  std::vector<double> measured = {};   ///< SI
  std::vector<double> predicted = {};  ///< SI; NaN between windows
};

/// What was predicted in one of several flights.
struct FlightPrediction {
  std::string flight;
  std::vector<PredictedQuantity> quantities = {};
};

/// The identified model validated on held-out data.
struct Validation {
  double period_s = 0.0;
  double simulated_s = 0.0;  ///< time that was predicted
  std::size_t windows = 0;
  std::size_t diverged = 0;   ///< windows in which the prediction left the envelope and was cut
  bool with_airspeed = true;  ///< false: airspeed was taken from the measurement, since drag or thrust is not known
  std::vector<PredictedQuantity> quantities;  ///< of several flights one after the other (PreparedFlight::shift_s)
  std::vector<FlightPrediction> by_flight;    ///< the same flight by flight, where there are several
  std::string text;                           ///< what was done, in one sentence
  [[nodiscard]] bool available() const { return windows > 0; }
};

/// Integrates the wind-axes force equations (see wind_axes.hpp) with the values of `subject.model`, driven by the
/// measured rates, attitude, deflections and thrust, and started again every `period_s` from the smoothed ground
/// velocity, wind and attitude. Airspeed and alpha are judged on the `longitudinal` spans (needs CL in `known`), beta
/// on the `lateral` ones (needs CY). Coefficients that are not in `known` are taken as measured: without CD the
/// airspeed is driven by the measurement. Fourth-order Runge-Kutta at the grid's step.
[[nodiscard]] Validation validate_flight(const FlightSignals& signals, std::span<const TimeSpan> longitudinal,
                                         std::span<const TimeSpan> lateral, const Subject& subject,
                                         std::span<const Coefficient> known, const ValidationOptions& options);

/// The same over several flights together: all windows of all of them, and the scores of each.
[[nodiscard]] Validation validate_flights(std::span<const PreparedFlight> flights, RowUse use, const Subject& subject,
                                          std::span<const Coefficient> known, const ValidationOptions& options);

}  // namespace veridyn::aircraft
