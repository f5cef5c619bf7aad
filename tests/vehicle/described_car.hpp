#pragma once

#include <string>

#include "veridyn/core/study.hpp"
#include "veridyn/vehicle/simulation_study.hpp"

namespace veridyn::vehicle::testing {

/// A car with all its numbers, as a study describes it.
inline constexpr const char* kCar = R"([subject]
kind = "vehicle"
mass = 1480
unsprung_mass = 38
a = 1.14
b = 1.50
track = 1.53
cg_height = 0.55
I_x = 540
I_y = 2150
I_z = 2350
C_f = 58000
C_r = 65000
K_s = 19000
C_s = 1650
K_t = 210000
mu = 0.9
)";

/// A study of a drive: `more` after a vehicle.
inline SimulationStudy read_drive_study(const std::string& more, const std::string& subject = kCar) {
  const Study study = Study::parse(subject + more, "study.toml");
  SimulationStudy out = read_simulation_study(study.root(), Progress());
  study.root().finish();
  return out;
}

}  // namespace veridyn::vehicle::testing
