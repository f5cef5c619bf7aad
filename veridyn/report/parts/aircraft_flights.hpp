#pragma once

#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::report {

/// Of a study with several recordings: what each is, which of them each manoeuvre came from, how well each is
/// predicted, and what each says of the parameters by itself. Without blocks where there is one recording.
[[nodiscard]] Section flights_section(const aircraft::FlightAnalysis& analysis);

}  // namespace veridyn::report
