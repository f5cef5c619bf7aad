#pragma once

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "veridyn/aircraft/identification/identification.hpp"
#include "veridyn/numerics/random.hpp"

/// Four minutes at 20 m/s in which alpha, q and elevator move independently and q' is such that the pitching moment is
/// the subject's: signals as a reconstruction leaves them, for tests of what identification makes of them.
namespace veridyn::aircraft::testing {

inline constexpr double kPitchingEnd_s = 240.0;
/// The last third is held out.
inline constexpr double kPitchingHoldout_s = 160.0;

/// What may be special about it; `later` is of the hold-out.
struct PitchingFlight {
  double noise = 0.002, later_noise = 0.002;    ///< of Cm; the sensors are said to leave 0.002
  double motion = 1.0, later_motion = 1.0;      ///< amplitude of alpha, q and elevator
  double elevator = 1.0, later_elevator = 1.0;  ///< effect of the elevator over the subject's
  double unmodelled = 0.0;                      ///< amplitude of a moment that no term of the model makes
  double follows_alpha = 0.0;                   ///< share of the elevator's motion that is alpha's
};

inline FlightSignals pitching(const Subject& subject, const PitchingFlight& flight = {}) {
  using F = FlightSignal;
  FlightSignals s;
  s.grid = numerics::UniformGrid::covering(0.0, kPitchingEnd_s, 0.05);
  s.stride = 1;
  for (auto& signal : s.signals) signal.value.assign(s.grid.count, 0.0);
  s.air_density.assign(s.grid.count, 1.2);
  numerics::RandomStream random(11, "pitching");
  const CoefficientModel& cm = *subject.model.find(Coefficient::kCm);
  const double Cm_de = cm.value_of("de").value();
  const double moment = 0.5 * 1.2 * 400.0 * subject.wing_area * subject.chord;
  for (std::size_t k = 0; k < s.grid.count; ++k) {
    const double t = s.grid.at(k);
    const bool later = t >= kPitchingHoldout_s;
    const double motion = later ? flight.later_motion : flight.motion, share = flight.follows_alpha;
    s[F::kAirspeed].value[k] = 20.0;
    s[F::kAlpha].value[k] = 0.08 + motion * 0.03 * std::sin(1.1 * t);
    s[F::kQ].value[k] = motion * 0.4 * std::sin(1.7 * t);
    s[F::kElevator].value[k] = motion * ((1.0 - share) * (0.05 * std::sin(2.3 * t) + 0.02 * std::cos(0.7 * t)) +
                                         share * 0.05 * std::sin(1.1 * t));
    const double effect = later ? flight.later_elevator : flight.elevator;
    const double Cm = cm.linear(aero_variables(s.sample(k), subject, 1.2)) +
                      (effect - 1.0) * Cm_de * s[F::kElevator].value[k] + flight.unmodelled * std::sin(0.37 * t) +
                      (later ? flight.later_noise : flight.noise) * random.normal();
    s[F::kQdot].value[k] = moment * Cm / subject.inertia->Jy;
  }
  s[F::kQdot].sigma = moment * 0.002 / subject.inertia->Jy;
  s[F::kQdot].error = ErrorKind::kClassical;
  return s;
}

/// Signals and segments as the only flight of a study.
inline std::vector<PreparedFlight> only_flight(FlightSignals signals, Segments segments) {
  std::vector<PreparedFlight> one(1);
  one.front().signals = std::move(signals);
  one.front().segments = std::move(segments);
  return one;
}

inline Segments pitching_segments() {
  Segments segments;
  segments.airborne = {{0.0, kPitchingEnd_s}};
  for (AxisSegments* axis : {&segments.longitudinal, &segments.lateral}) {
    axis->excited = segments.airborne;
    axis->identification = {{0.0, kPitchingHoldout_s}};
    axis->holdout = {{kPitchingHoldout_s, kPitchingEnd_s}};
  }
  return segments;
}

/// Flights of an aircraft whose Cm differs from flight to flight, by `scatter` of each parameter.
inline std::vector<PreparedFlight> pitching_set(const Subject& subject, std::size_t count, double scatter,
                                                std::uint64_t seed) {
  numerics::RandomStream random(seed, "pitching set");
  std::vector<PreparedFlight> flights;
  for (std::size_t i = 0; i < count; ++i) {
    Subject flown = subject;
    CoefficientModel cm = *flown.model.find(Coefficient::kCm);
    for (double& value : cm.values) value *= 1.0 + scatter * random.normal();
    flown.model.set(cm);
    FlightSignals signals = pitching(flown, {.noise = 0.0, .later_noise = 0.0});
    const double moment = 0.5 * 1.2 * 400.0 * subject.wing_area * subject.chord;
    for (double& qdot : signals[FlightSignal::kQdot].value)
      qdot += moment * 0.002 / subject.inertia->Jy * random.normal();
    flights.push_back(only_flight(std::move(signals), pitching_segments()).front());
    flights.back().name = fmt::format("flight{}.csv", i + 1);
  }
  return flights;
}

/// Cm of that flight; by OLS unless another method, or none (the comparison's choice), is given.
inline CoefficientResult identified_cm(const Subject& subject, const FlightSignals& signals,
                                       std::optional<estimation::Method> method = estimation::Method::kOls) {
  IdentifyOptions options;
  options.coefficients = {Coefficient::kCm};
  options.method = method;
  Progress silent;
  return identify_coefficients(only_flight(signals, pitching_segments()), subject, options, silent).coefficients.at(0);
}

}  // namespace veridyn::aircraft::testing
