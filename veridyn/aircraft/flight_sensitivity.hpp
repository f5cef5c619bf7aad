#pragma once

#include <string>
#include <vector>

#include "veridyn/aircraft/simulation/simulation.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/uncertainty/response_indices.hpp"

namespace veridyn::aircraft {

/// What varies and how indices are computed. Study table `[sensitivity]`.
struct FlightSensitivityOptions : estimation::IndexOptions {
  double longest = 10.0;  ///< [s]
  estimation::GivenInputs given = {};

  [[nodiscard]] static const KeyTable<FlightSensitivityOptions>& keys();
};

/// A study of which parameter of an aircraft moves which manoeuvre and signal of a simulated flight, read and checked.
struct FlightSensitivityStudy {
  SimulationOptions flight;
  std::vector<estimation::IndexInput> inputs = {};
  FlightSensitivityOptions options = {};
};

/// Reads the flight (`read_simulation`) and `[sensitivity]`, where what may vary are the parameters of the aerodynamic
/// model by name (CL_alpha), `mass` and Jx, Jy, Jz, Jxz; without inputs all of them that are not zero.
/// @throws InputError with file, line and key; also for a flight with [[flight.change]], and where an end of a range is
/// no aircraft's.
[[nodiscard]] FlightSensitivityStudy read_flight_sensitivity(const StudyTable& root);

/// Which input moves which manoeuvre and which signal. The nominal aircraft is flown by the simulated pilot once; of
/// every manoeuvre (from its start to one second after its end, `longest` at most) the state at its beginning,
/// deflections, throttle and air are kept, and the changed aircraft flies it again open loop (`FlightReplay`). A pilot
/// would hide what differs, and a whole flight without one leaves the nominal one whatever differs.
///
/// Results: of each manoeuvre the root mean square over all signals, of each signal over all manoeuvres, of the
/// difference from the nominal replay over the signal's standard deviation in the whole flight. A run in which the
/// aircraft departs has no result.
/// @throws InputError as `simulate`; std::runtime_error where the nominal flight ends early.
[[nodiscard]] estimation::ResponseIndices analyse_flight(const FlightSensitivityStudy& study,
                                                         numerics::BlockStore& store, Progress& progress);

}  // namespace veridyn::aircraft
