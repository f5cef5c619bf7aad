#pragma once

#include <fmt/format.h>

#include <string>

namespace veridyn::test {

/// The beginning of a study of a simulated flight: a minute of multisine on the elevator.
inline std::string elevator_flight(int seed) {
  return fmt::format(R"toml(seed = {}
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
)toml",
                     seed);
}

}  // namespace veridyn::test
