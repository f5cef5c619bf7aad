#pragma once

#include "veridyn/muscle/muscle_reproduction.hpp"
#include "veridyn/report/reproduction_report.hpp"

namespace veridyn::report {

/// A row of `veridyn reproduce muscle`: cases side by side, and a picture of every hidden person's parameter error
/// against the error of unseen tasks.
[[nodiscard]] ReproducedRow reproduced_row(const muscle::MuscleReproduction& reproduction);

}  // namespace veridyn::report
