#pragma once

#include <span>
#include <string>
#include <vector>

#include "veridyn/core/recording.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/vehicle/identification/drive_log.hpp"

namespace veridyn::vehicle {

/// Which stretches of a drive tell about its tyres. Study table `[segments]`; every key is optional.
struct DriveSegmentOptions {
  double min_speed_mps = 3.0;     ///< `min_speed`: slip angles lose their meaning below it
  double max_steer_rad = 1.0472;  ///< `max_steer` (60 deg): beyond it the drive is not used
  /// `min_lateral_acceleration`: rms of r u over `window` from which a stretch counts as excited.
  double min_lateral_mps2 = 0.3;
  double window_s = 2.0;        ///< `window`
  double merge_s = 3.0;         ///< `merge`: excited stretches closer than this are one
  double min_duration_s = 3.0;  ///< `min_duration`
  double holdout = 1.0 / 3.0;   ///< `holdout`: share kept from identification, in [0, 0.8]
  double block_s = 10.0;  ///< `block`: stretches are dealt to identification and hold-out in blocks of this length
  double guard_s = 0.5;   ///< `guard`: cut from both sides where blocks of different use meet
  std::vector<TimeSpan> identification_spans;  ///< `identification = [10, 60, 80, 95]`: begin and end of each, as given
  std::vector<TimeSpan> holdout_spans;         ///< `holdout_spans`

  /// @throws InputError for values that make no sense.
  [[nodiscard]] static DriveSegmentOptions read(const StudyTable& table);
};

/// Stretches of a drive and how they were dealt.
struct DriveSegments {
  std::vector<TimeSpan> usable;   ///< all signals there, fast enough, wheels turned by less than `max_steer`
  std::vector<TimeSpan> excited;  ///< of these, where there is lateral motion
  std::vector<TimeSpan> identification;
  std::vector<TimeSpan> holdout;
  bool given = false;  ///< by the user
  std::string text;    ///< one sentence for the report
  [[nodiscard]] double seconds(const std::vector<TimeSpan>& spans) const;
};

/// Finds them. Blocks are dealt in turn, so that both uses see every kind of driving; whole runs where runs are named
/// for hold-out.
/// @param holdout_runs stretches that belong to the hold-out as a whole
/// @throws InputError when the vehicle stands throughout, when no stretch is usable (saying why: speed, steering beyond
/// the limit, gaps), or spans lie outside the recording.
[[nodiscard]] DriveSegments find_drive_segments(const DriveSignals& signals, const DriveSegmentOptions& options,
                                                std::span<const TimeSpan> holdout_runs = {});

}  // namespace veridyn::vehicle
