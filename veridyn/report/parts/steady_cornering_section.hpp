#pragma once

#include "veridyn/report/document/document.hpp"
#include "veridyn/vehicle/simulation_study.hpp"

namespace veridyn::report {

/// Understeer and roll gradient of a simulated vehicle, in deg/g and SI: of gentle turns (the four-wheel model with all
/// that steers and rolls in it), of the linear bicycle, and as this drive shows them, where it is a steady turn; of
/// such a drive the diagrams with their slopes too.
[[nodiscard]] Section steady_cornering_section(const vehicle::SimulationStudy& study,
                                               const vehicle::SimulationRun& run);

}  // namespace veridyn::report
