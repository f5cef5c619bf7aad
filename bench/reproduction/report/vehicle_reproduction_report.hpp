#pragma once

#include "bench/reproduction/report/reproduction_report.hpp"
#include "bench/reproduction/vehicle/vehicle_reproduction.hpp"

namespace veridyn::report {

/// A row of `veridyn reproduce vehicle`: printed numbers alongside ours, the table of groups, and all curves of
/// prototype and model laid over each other after scaling.
[[nodiscard]] ReproducedRow reproduced_row(const vehicle::VehicleReproduction& reproduction);

}  // namespace veridyn::report
