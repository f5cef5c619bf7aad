#pragma once

#include <span>

#include "veridyn/aircraft/reproduction.hpp"
#include "veridyn/report/document.hpp"

namespace veridyn::report {

/// The report of `veridyn reproduce aircraft`: a table of all rows, then per row the published figures beside ours,
/// what was checked, and its picture.
[[nodiscard]] Document reproduction_report(std::span<const aircraft::Reproduction> rows, const std::string& program);

}  // namespace veridyn::report
