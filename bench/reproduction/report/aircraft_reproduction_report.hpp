#pragma once

#include "bench/reproduction/aircraft/reproduction.hpp"
#include "bench/reproduction/report/reproduction_report.hpp"

namespace veridyn::report {

/// A row of `veridyn reproduce aircraft`: published and reproduced parameters side by side, and its picture.
[[nodiscard]] ReproducedRow reproduced_row(const aircraft::Reproduction& reproduction);

}  // namespace veridyn::report
