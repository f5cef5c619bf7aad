#pragma once

#include "bench/reproduction/muscle/muscle_reproduction.hpp"
#include "bench/reproduction/report/reproduction_report.hpp"

namespace veridyn::report {

/// A row of `veridyn reproduce muscle`: cases side by side, and a picture of every hidden person's parameter error
/// against the error of unseen tasks.
[[nodiscard]] ReproducedRow reproduced_row(const muscle::MuscleReproduction& reproduction);

}  // namespace veridyn::report
