#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/aircraft/sensors/sensors.hpp"
#include "veridyn/aircraft/simulation/dryden.hpp"
#include "veridyn/aircraft/simulation/flight_plan.hpp"
#include "veridyn/aircraft/simulation/wind.hpp"
#include "veridyn/core/constants.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/core/recording.hpp"

namespace veridyn::aircraft {

/// A change of the aircraft in flight: ice, damage, a wing that stalls or recovers. From `time` on the model is
/// `model`.
struct ModelChange {
  double time = 0.0;  ///< [s]
  AeroModel model;
  std::string text;  ///< what changed, in words: "Cm_alpha -0.7 to -0.35"
};

/// The flight to simulate. Study table `[flight]`.
struct SimulationOptions {
  Subject subject;
  double duration = 300.0;    ///< [s]
  double altitude = 100.0;    ///< above sea level [m]
  double ground = 0.0;        ///< above sea level [m]
  double airspeed = 0.0;      ///< [m/s]; 0: where the lift coefficient is 0.5
  double heading = 0.0;       ///< [rad]
  double step = 0.0025;       ///< [s]
  double truth_rate = 100.0;  ///< [Hz]; rounded to whole steps
  double gravity = kGravity;
  double excitation_gain = 0.3;
  WindSettings wind;
  DrydenSettings turbulence;
  bool gust_gradients = false;  ///< turbulence turns the air too: see `GustGradients`
  SensorSet sensors = reference_sensors();
  bool log_commands = false;                         ///< the servos' channels are commands, not deflections
  double lost_rows = 0.0;                            ///< share of rows of the log that are lost: see `lose_rows`
  std::optional<std::vector<Manoeuvre>> manoeuvres;  ///< none: `default_plan`
  std::vector<ModelChange> changes = {};             ///< by time
  std::uint64_t seed = 1;

  /// Of an object that has its subject.
  [[nodiscard]] static const KeyTable<SimulationOptions>& keys();
};

/// Why a simulated flight ended.
enum class FlightEnd {
  kCompleted,    ///< flown to the end
  kInterrupted,  ///< the caller's progress asked to stop
  kDiverged,     ///< the state became NaN or infinite: the step is too long for this aircraft
  kNoTrim,       ///< steady level flight at the desired airspeed does not exist
  kGround,       ///< touched the ground
  kUpset,        ///< angle of attack beyond 90 deg or rates beyond 50 rad/s, where the model means nothing
};

/// A simulated flight: what the sensors saw and what was true (see kTruthChannels).
struct SimulatedFlight {
  Recording measured;
  Recording truth;
  std::vector<Manoeuvre> manoeuvres;
  Trim trim;
  double end_time = 0.0;                    ///< [s]
  double alpha_min = 0.0, alpha_max = 0.0;  ///< gusts included [rad]
  FlightEnd end = FlightEnd::kCompleted;
  [[nodiscard]] bool usable() const { return end == FlightEnd::kCompleted; }
  [[nodiscard]] std::string message() const;
};

/// Airspeed of level flight at CL = 0.5 and sea-level density [m/s], for aircraft that name none.
[[nodiscard]] double default_airspeed(const Subject& subject, double gravity = kGravity);

/// Flies the subject: six degrees of freedom with the attitude as quaternion, fixed steps of the fourth-order
/// Runge-Kutta method, controls and gusts varying linearly within a step. Same options, same bytes. A flight that fails
/// keeps what was simulated until then, and so does one that `progress` interrupts, which takes at most 2000 steps.
/// @throws InputError when the subject lacks inertia or a parameter of its model has no value.
[[nodiscard]] SimulatedFlight simulate(const SimulationOptions& options, Progress& progress);

}  // namespace veridyn::aircraft
