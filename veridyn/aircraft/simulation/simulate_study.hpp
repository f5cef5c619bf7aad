#pragma once

#include "veridyn/aircraft/simulation/simulation.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::aircraft {

/// Reads from the root of a study what `simulate` needs: `seed`, `[subject]`, `[flight]`, `[sensors]`. Other keys of
/// the root are left to others; `Study::root().finish()` finds the misspelt ones.
/// @throws InputError with file, line and key.
[[nodiscard]] SimulationOptions read_simulation(const StudyTable& root);

/// Reads the study and flies it.
[[nodiscard]] SimulatedFlight simulate_study(const StudyTable& root, Progress& progress);

}  // namespace veridyn::aircraft
