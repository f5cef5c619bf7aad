#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/io/log/log.hpp"

namespace veridyn::io {

/// A pause in which nothing is logged parts a log from so long on [s]; of a slow table from 20 of its rows on.
inline constexpr double kPause_s = 30.0;
/// What is shorter is no part: parameters that are written when the autopilot starts [s].
inline constexpr double kShortestPart_s = 5.0;

/// The flights or drives of a log: stretches between pauses and restarts (`Log::restarts`), in order. One or none where
/// nothing parts it.
[[nodiscard]] std::vector<TimeSpan> log_parts(const Log& log);

/// Where a log has several parts: leaves the one that `part` numbers from 1, rows and events, or all with a note that
/// lists them (0). What was one part of its file already (`Log::part`) stays.
/// @throws InputError where there is no such part; it lists them.
void choose_part(Log& log, std::size_t part);

}  // namespace veridyn::io
