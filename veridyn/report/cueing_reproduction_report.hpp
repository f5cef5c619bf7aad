#pragma once

#include "veridyn/cueing/reproduction/cueing_reproduction.hpp"
#include "veridyn/report/reproduction_report.hpp"

namespace veridyn::report {

/// A row of `veridyn reproduce cueing`: figures alongside ours with where they come from, and what was driven.
[[nodiscard]] ReproducedRow reproduced_row(const cueing::CueingReproduction& reproduction);

}  // namespace veridyn::report
