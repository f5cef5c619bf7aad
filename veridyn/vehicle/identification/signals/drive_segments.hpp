#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/recording/segments.hpp"
#include "veridyn/vehicle/identification/signals/drive_signals.hpp"

namespace veridyn::vehicle {

/// Which stretches of a drive are used; the window is 2 s by default, and the rms of r u is taken over it.
/// Study table `[segments]`.
struct DriveSegmentOptions : recording::SegmentOptions {
  double min_speed_mps = 3.0;
  double max_steer_rad = 60.0 * kDegree;
  std::optional<double> min_lateral_mps2 = {};  ///< rms of r u over the window; nothing: by the drive
  std::vector<TimeSpan> identification_spans;   ///< as given
  std::vector<TimeSpan> holdout_spans;

  DriveSegmentOptions();
  [[nodiscard]] static const KeyTable<DriveSegmentOptions>& keys();
};

/// Stretches of a drive and how they are used.
struct DriveSegments : recording::Segments {
  double least_lateral_mps2 = 0.0;  ///< from which a stretch counted as excited
  std::vector<TimeSpan> usable;     ///< all signals there, fast enough, wheels turned by less than `max_steer`
};

/// Finds them. Blocks are assigned in turn, so that both uses see every kind of driving; whole runs where runs are
/// named for hold-out.
/// @param holdout_runs stretches that belong to the hold-out as a whole
/// @throws InputError when the vehicle never moves, when no stretch is usable (saying why: speed, steering beyond
/// the limit, gaps), or spans lie outside the recording.
[[nodiscard]] DriveSegments find_drive_segments(const DriveSignals& signals, const DriveSegmentOptions& options,
                                                std::span<const TimeSpan> holdout_runs = {});

}  // namespace veridyn::vehicle
