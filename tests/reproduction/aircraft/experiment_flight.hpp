#pragma once

namespace veridyn::aircraft {

/// The beginning of an experiment's study: a minute of multisine on the elevator.
inline constexpr const char* kExperimentFlight = R"toml(seed = 3
[subject]
builtin = "unatrap"
[flight]
duration = 60
airspeed = 20
[[flight.manoeuvre]]
kind = "multisine"
start = 0
duration = 60
surfaces = ["elevator"]
)toml";

}  // namespace veridyn::aircraft
