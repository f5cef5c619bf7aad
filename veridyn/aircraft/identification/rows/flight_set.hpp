#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "veridyn/aircraft/identification/rows/prepared_flight.hpp"
#include "veridyn/estimation/result/estimate.hpp"

/// What several flights of one aircraft are together.
namespace veridyn::aircraft {

/// Where the figures of several flights show one after the other, this much lies between them [s].
inline constexpr double kBetweenFlights_s = 10.0;

/// `text` of a flight: with its name in front where it has one.
[[nodiscard]] std::string of_flight(std::string_view name, std::string_view text);

/// Segments of a flight that identification must not use: all that is excited is for the hold-out.
[[nodiscard]] Segments all_held_out(Segments segments);

/// What the recordings of several flights were for; empty where there is one. `tried`: all that is excited tries an
/// estimate from elsewhere.
[[nodiscard]] std::vector<estimation::RecordingUse> recording_uses(std::span<const PreparedFlight> flights, bool tried);

/// Flights that are prepared, as a set: one after the other on the axis of the figures, each row of evidence with its
/// flight's name. Flights that give nothing are named by a row of evidence, in place of their other rows where their
/// motion is not known (left out):
/// - *flight left out*: its motion is contradicted;
/// - *nothing excited*: neither axis has an excited segment.
/// @param flights  at least two
[[nodiscard]] std::vector<PreparedFlight> side_by_side(std::vector<PreparedFlight> flights);

}  // namespace veridyn::aircraft
