#pragma once

#include <optional>
#include <span>

#include "veridyn/aircraft/reconstruction/model_based_filter.hpp"
#include "veridyn/aircraft/reconstruction/reconstruct.hpp"

namespace veridyn::aircraft {

/// What a guarded filter is told about the aircraft from a time on.
struct TimedModel {
  double from_s = 0.0;
  std::optional<AeroModel> aero;  ///< values of CL, and of CD and CY as far as known; none: no model
  ModelError error;               ///< `modelled` says which of the three `aero` has
};

/// What GuardedFilter makes of a recording when its model comes piece by piece, as from a recursive identification.
///
/// Channels on the gyro's stamps (or at `rate_Hz`): those of `Reconstruction::filtered` with `model_based` and
/// `guard_ratio`; nothing of it has seen later samples. There is no smoother.
/// @param subject mass, geometry, propulsion, and the terms of CL, CD and CY; their values are not used
/// @param models in the order of their times; before the first one there is none
/// @param turbulence the gust spectrum
/// @throws InputError as `reconstruct`, and for errors of vanes and pitot tube among `options`: those need the whole
/// flight
[[nodiscard]] Recording replay_guarded(const Recording& mapped, const ReconstructOptions& options,
                                       const Subject& subject, std::span<const TimedModel> models,
                                       const DrydenSettings& turbulence, Progress& progress);

}  // namespace veridyn::aircraft
