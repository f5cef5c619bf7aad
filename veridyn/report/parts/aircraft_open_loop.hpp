#pragma once

#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// What the identified aircraft does open loop, from deflections and thrust alone: scores of each state, predicted
/// against measured with the 95 % bands, where each window started. Without blocks where nothing was asked for.
[[nodiscard]] Section open_loop_section(const aircraft::FlightAnalysis& analysis);

}  // namespace veridyn::report
