#pragma once

#include "bench/reproduction/cueing/cueing_reproduction.hpp"
#include "bench/reproduction/report/reproduction_report.hpp"

namespace veridyn::report {

/// A row of `veridyn reproduce cueing`: figures alongside ours with where they come from, and what was driven.
[[nodiscard]] ReproducedRow reproduced_row(const cueing::CueingReproduction& reproduction);

}  // namespace veridyn::report
