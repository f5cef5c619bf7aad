#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/recording/segments.hpp"
#include "veridyn/vehicle/identification/signals/drive_signals.hpp"

namespace veridyn::vehicle {

/// Which stretches of a drive are used: keys of recording::SegmentOptions (`window`: 2 s by default, the
/// rms of r u is taken over it) and these. Study table `[segments]`; every key is optional.
struct DriveSegmentOptions : recording::SegmentOptions {
  double min_speed_mps = 3.0;     ///< `min_speed`: slip angles mean nothing below it
  double max_steer_rad = 1.0472;  ///< `max_steer` (60 deg): beyond it the drive is not used
  /// `min_lateral_acceleration`: rms of r u over `window` from which a stretch counts as excited. Nothing: 0.3 m/s^2,
  /// or where a drive is gentler half of what its liveliest twentieth exceeds, down to 0.05 m/s^2.
  std::optional<double> min_lateral_mps2 = {};
  std::vector<TimeSpan> identification_spans;  ///< `identification = [10, 60, 80, 95]`: begin and end of each, as given
  std::vector<TimeSpan> holdout_spans;         ///< `holdout_spans`

  DriveSegmentOptions();
  /// @throws InputError for values that make no sense.
  [[nodiscard]] static DriveSegmentOptions read(const StudyTable& table);
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
