#pragma once

#include <span>
#include <string>

#include "veridyn/aircraft/sensors/channel_rules.hpp"

namespace veridyn::aircraft::internal {

/// What a channel of an autopilot's log is that follows the airspeed.
enum class AirspeedKind {
  kTrue,         ///< true airspeed
  kEquivalent,   ///< indicated by a tube that the autopilot calibrated: sqrt(2 q / rho_0)
  kRawPressure,  ///< of the sensor, without the calibration of the autopilot
};

/// A channel from which airspeed or dynamic pressure can be had.
struct AirspeedSource {
  std::string source;  ///< channel of the log
  AirspeedKind kind;
  std::string unit;  ///< of the raw numbers where the log gives none
  std::string note;  ///< for the report
};

/// Takes the first source that is alive, unless the study maps `airspeed` or `dynamic_pressure` or one of them is
/// there: as `airspeed` where it is true, else as the `dynamic_pressure` rho_0 V^2 / 2 that it follows from, so that
/// what a study says a channel `airspeed` is does not matter. The others are left. Sources that the autopilot
/// calibrated stand first.
void map_airspeed(MapBuilder& builder, std::span<const AirspeedSource> sources);

/// The dynamic pressure of ArduPilot's tube, rho_0/2 ARSPD_RATIO DiffPress: as fresh as the sensor, and as calibrated
/// as ARSP.Airspeed, which is sqrt(ARSPD_RATIO DiffPress) behind a filter. Where the log's own two channels contradict
/// ARSPD_RATIO by more than a tenth (it was learned in flight, or DiffPress has its offset), or it has none, the ratio
/// is theirs, or nothing is taken if theirs is not one number.
void map_ardupilot_pressure(MapBuilder& builder);

}  // namespace veridyn::aircraft::internal
