#pragma once

#include <cstdint>
#include <memory>

#include "veridyn/core/study.hpp"
#include "veridyn/vehicle/road/road.hpp"

namespace veridyn::vehicle {

/// The road that a study's `[road]` describes; a level one where the table is empty.
///
///     kind = "flat"                     # also "step", "ramp", "bump", "plank", "iso8608", "file"
///
///     at = 20, height = 0.05            # step, ramp, bump, plank: [m], where it begins and how high it is (< 0: hole)
///     length = 0.5                      # [m]; of a step the distance over which it rises (default 0: at once)
///     side = "both"                     # or "left", "right"
///
///     class = "C"                       # iso8608: A to H, or the density itself:
///     roughness = 256e-6                # [m^3] G_d(0.1 cycle/m)
///     waviness = 2, length = 1000       # exponent; [m] before it repeats
///     coherence_length = 4, fade_in = 10  # [m], see `Iso8608Options`
///     seed = 7                          # default: from `seed`
///
///     file = "profile.csv"              # file: distance[m], left[m], right[m] (or height[m]); or OpenCRG, .crg
///
/// @throws InputError with file, line and key.
[[nodiscard]] std::shared_ptr<const Road> read_road(const StudyTable& road, std::uint64_t seed);

}  // namespace veridyn::vehicle
