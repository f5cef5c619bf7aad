#pragma once

#include "veridyn/aircraft/tracking/coefficient_tracker.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// Decimal logarithms of a tracker's singular values over the moments of its history, with the excitation threshold.
[[nodiscard]] Panel singular_value_panel(const aircraft::TrackHistory& history);

}  // namespace veridyn::report
