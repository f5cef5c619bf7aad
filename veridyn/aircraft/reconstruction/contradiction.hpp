#pragma once

#include <optional>

#include "veridyn/aircraft/reconstruction/reconstruct.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_run.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct_streams.hpp"

/// Inside of reconstruct.cpp: what a run that ended by dead reckoning means.
namespace veridyn::aircraft::internal {

/// The sensor that is lost according to `monitors`, which contradicts what its quantity was dead reckoned from; nothing
/// where none is.
[[nodiscard]] std::optional<Contradiction> contradiction_of(const FlightStreams& streams, const Monitors& monitors);

}  // namespace veridyn::aircraft::internal
