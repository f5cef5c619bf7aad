#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "veridyn/core/study.hpp"
#include "veridyn/vehicle/road/road.hpp"

namespace veridyn::vehicle {

/// The keys of `[road]`, each table with the kinds of road that it is of.
[[nodiscard]] std::vector<StudyKeys> road_keys();

/// The road that a study's `[road]` describes; a level one where the table is empty.
/// @param seed  of a random road that has none of its own
/// @throws InputError with file, line and key.
[[nodiscard]] std::shared_ptr<const Road> read_road(const StudyTable& road, std::uint64_t seed);

}  // namespace veridyn::vehicle
