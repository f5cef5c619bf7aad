#pragma once

#include <complex>
#include <optional>

#include "veridyn/aircraft/model/linear_modes.hpp"
#include "veridyn/aircraft/model/subject.hpp"
#include "veridyn/aircraft/model/trim.hpp"
#include "veridyn/core/enum_array.hpp"

namespace veridyn::aircraft {

/// Whether a mode has two roots: an oscillation, or where it is damped so heavily two motions without one.
[[nodiscard]] constexpr bool has_two_roots(Mode mode) { return mode != Mode::kRoll && mode != Mode::kSpiral; }

/// The roots of the characteristic equation that make up a mode [1/s]. Of an oscillation both are conjugate; of roll
/// and spiral both are the one real root.
struct NaturalMode {
  std::complex<double> first, second;

  /// Undamped natural frequency [rad/s]; NaN where one of two real roots grows.
  [[nodiscard]] double frequency() const;
  /// Damping ratio; above 1 where there is no oscillation, below 0 where one grows.
  [[nodiscard]] double damping() const;
  /// Rate at which what decays slowest decays [1/s]; negative: grows.
  [[nodiscard]] double decay() const;
};

/// What the equations of small motions about straight flight say.
struct FlightModes {
  EnumArray<Mode, std::optional<NaturalMode>, kModes> modes;
  double load_factor_per_alpha = 0.0;  ///< n/alpha at constant speed [1/rad]; NaN without lift
  double control_anticipation = 0.0;   ///< CAP = frequency^2 of the short period / (n/alpha) [rad/s^2 per g]; NaN: none
  bool longitudinal_whole = false;     ///< of all four states; else the short period of alpha and q alone
  bool lateral_whole = false;          ///< else Dutch roll of beta and r, roll of p alone
};

/// What changes with airspeed at a given alpha and is in no coefficient that manoeuvres at one airspeed determine.
struct SpeedEffects {
  /// The thrust of an engine that is not modelled goes with Va^-thrust: 0 for a jet and for no engine, 1 at constant
  /// power, about 2 for a propeller of fixed pitch whose thrust nears its end.
  double thrust = 0.5;
  /// The lift goes with Va^(2 + 2 lift): by slipstream, by compressibility.
  double lift = 0.0;
};

/// The modes in straight and level flight, as far as the subject's coefficients are known: those whose parameters all
/// have a value. Airspeed and density are those of `near`; alpha is where the lift carries the weight, the elevator
/// where nothing pitches, the throttle where the thrust balances the drag, as that of an engine that is not modelled
/// does too. The controls are held.
///
/// Whole motions (u, w, q, theta) and (v, p, r, phi) need all of CL, CD, Cm and of CY, Cl, Cn; motions of both together
/// are left out, as textbooks do (Etkin & Reid 1996, chapter 6). The roots of the first are the short period, the two
/// larger, and the phugoid; of the second the pair is the Dutch roll, the real ones roll and spiral; of four real ones
/// the two in the middle are the Dutch roll. Where they come in another order (a third oscillatory mode, roll and
/// spiral in one) the modes that do not exist are missing.
[[nodiscard]] FlightModes flight_modes(const Subject& subject, const Trim& near, const SpeedEffects& effects = {});

}  // namespace veridyn::aircraft
