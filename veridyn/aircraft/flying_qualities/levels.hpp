#pragma once

#include <optional>
#include <string_view>

#include "veridyn/aircraft/model/modes.hpp"
#include "veridyn/core/enum_array.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::aircraft {

/// Of MIL-F-8785C, 1.3: small and light, medium, large and heavy, of high manoeuvrability.
enum class AircraftClass { kI, kII, kIII, kIV };
inline constexpr EnumArray<AircraftClass, std::string_view, 4> kAircraftClassNames{{"I", "II", "III", "IV"}};

/// Of MIL-F-8785C, 1.4: rapid manoeuvring and precise tracking, gradual manoeuvres, take-off and landing.
enum class FlightPhase { kA, kB, kC };
inline constexpr EnumArray<FlightPhase, std::string_view, 3> kFlightPhaseNames{{"A", "B", "C"}};

/// What flying qualities are asked for. Study table `[flying_qualities]`.
struct FlyingQualities {
  AircraftClass aircraft_class = AircraftClass::kI;
  FlightPhase phase = FlightPhase::kB;
  std::optional<double> airspeed = {};  ///< in straight flight [m/s]; nothing: the median of what was excited

  [[nodiscard]] static const KeyTable<FlyingQualities>& keys();
};

inline constexpr int kNoLevel = 4;  ///< worse than level 3

/// The level (1 to 3, or kNoLevel) of a mode by MIL-F-8785C (1980): short period by its damping (3.2.2.1.2, table IV)
/// and by CAP (3.2.2.1.1, figures 1 to 3, their lines of constant CAP alone); phugoid by 3.2.1.2; Dutch roll by
/// damping, their product and frequency (3.3.1.1, table VI); roll by its time constant (3.3.1.2, table VII); spiral by
/// the time in which it doubles (3.3.1.3, table VIII). The numbers are of piloted aircraft: a model of one at scale 1/n
/// is sqrt(n) times as fast. Class II is land based.
[[nodiscard]] int level_of(Mode mode, const NaturalMode& motion, double control_anticipation,
                           const FlyingQualities& asked);

}  // namespace veridyn::aircraft
