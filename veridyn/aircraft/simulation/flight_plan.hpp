#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/aircraft/model/trim.hpp"
#include "veridyn/core/enum_array.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::aircraft {

/// What the pilot moves.
enum class Surface { kElevator, kAileron, kRudder, kThrottle };
inline constexpr std::size_t kSurfaces = 4;  ///< values of Surface
/// A value for each surface.
template <typename T>
using PerSurface = EnumArray<Surface, T, kSurfaces>;
/// As in studies and logs.
inline constexpr PerSurface<std::string_view> kSurfaceNames{{"elevator", "aileron", "rudder", "throttle"}};

/// Shapes of planned inputs.
enum class ManoeuvreKind {
  kDoublet,    ///< +1, -1 pulses
  k3211,       ///< +3, -2, +1, -1 pulses
  kMultisine,  ///< sums of sines on several surfaces at once that are orthogonal to each other (Morelli 2003)
  kTurn,       ///< a steady turn of given bank
  kPulse,      ///< one pulse, held: a pull into a stall
};

/// A planned input of the pilot. In all but turns, the surfaces get a deflection in addition to the autopilot's.
struct Manoeuvre {
  ManoeuvreKind kind = ManoeuvreKind::kDoublet;
  double start = 0.0;                  ///< [s]
  double duration = 0.0;               ///< [s]; multisines and turns
  std::vector<Surface> surfaces = {};  ///< in doublets and 3-2-1-1 one after another, with two seconds between
  std::vector<double> amplitude = {};  ///< largest deflection [rad] (throttle [-]), one per surface
  double pulse = 0.5;                  ///< length of one unit of a doublet or 3-2-1-1 [s]
  double f_min = 0.1;                  ///< multisine band [Hz]
  double f_max = 2.0;
  double bank = 0.0;  ///< of a turn [rad]; positive to the right

  [[nodiscard]] double end() const;
  /// Of one `[[flight.manoeuvre]]`; what has no amplitude is left without.
  [[nodiscard]] static const KeyTable<Manoeuvre>& keys();
};

/// Largest deflections that keep a small excitation small, from the linear model about a trim: the elevator changes
/// alpha by about 3 deg in the steady state, the aileron rolls at 20 deg/s, the rudder yields 4 deg of sideslip; never
/// more than half of the travel to a stop. Throttle 0.15.
[[nodiscard]] PerSurface<double> default_amplitudes(const Subject& subject, const Trim& trim, const LinearModel& model);

/// A plan of five minutes that excites everything twice, for identification and for validation: multisines on the
/// elevator, then on aileron and rudder, 3-2-1-1 and doublets on each surface, a change of throttle, a turn each way
/// and straight legs. Repeated for longer flights; what does not end before `duration` is left out.
[[nodiscard]] std::vector<Manoeuvre> default_plan(double duration, const PerSurface<double>& amplitudes);

/// One multisine: harmonics of 1/duration with phases of low peak.
struct Multisine {
  std::vector<double> frequency;  ///< [Hz], whole multiples of 1/duration
  std::vector<double> phase;      ///< [rad]
  double gain = 1.0;              ///< such that the largest value over the duration is 1
  [[nodiscard]] double value(double t) const;
};

/// Multisines for `count` surfaces: the harmonics of 1/duration in the band are assigned in turn, so that any two
/// signals are orthogonal over the duration. Phases start at Schroeder's (1970) and are improved for a low peak; the
/// signals start at a zero. Deterministic.
[[nodiscard]] std::vector<Multisine> make_multisines(std::size_t count, double duration, double f_min, double f_max);

/// The manoeuvres of a flight as functions of time.
class Excitation {
 public:
  explicit Excitation(std::vector<Manoeuvre> manoeuvres);

  /// What is added to each surface at `t`.
  [[nodiscard]] PerSurface<double> at(double t) const;
  /// Which surfaces are excited at `t`.
  [[nodiscard]] PerSurface<bool> excited(double t) const;
  /// Bank of the turn at `t` [rad]; NaN outside turns.
  [[nodiscard]] double bank(double t) const;
  [[nodiscard]] const std::vector<Manoeuvre>& manoeuvres() const { return manoeuvres_; }

 private:
  std::vector<Manoeuvre> manoeuvres_;
  std::vector<std::vector<Multisine>> sines_;
};

/// "multisine", as in a study.
[[nodiscard]] std::string_view name_of(ManoeuvreKind kind);

}  // namespace veridyn::aircraft
