#pragma once

#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/estimate.hpp"
#include "veridyn/vehicle/tracking/drive_tracker.hpp"
#include "veridyn/vehicle/vehicle_study.hpp"

namespace veridyn::vehicle {

/// A drive tracked on line, from a whole recording or one that is still being written: both ways take the same samples
/// of the same grid (whole multiples of its step), so the result does not depend on the pieces.
class TrackedDrive {
 public:
  /// @throws InputError when the estimate to begin with (`[track] estimate`) cannot be read
  explicit TrackedDrive(const VehicleStudy& study);

  /// Takes what the recording holds beyond what was taken before. `finished`: nothing will follow.
  /// @return the changes found. @throws InputError when channels are missing
  std::vector<DriveChange> advance(const recording::MappedRecording& mapped, bool finished, Progress& progress);

  /// Null before the first 20 s of the drive: noise and rate are learned from them.
  [[nodiscard]] const DriveTracker* tracker() const { return tracker_ ? &*tracker_ : nullptr; }
  /// What was assumed of the signals.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
  /// As DriveTracker::estimate; without parameters before the first 20 s of the drive.
  [[nodiscard]] estimation::Estimate estimate() const;

 private:
  std::string subject_;
  VehicleParameters<double> start_;
  DriveTrackOptions options_;
  DriveSignalOptions signals_;
  double min_speed_;
  std::optional<estimation::Estimate> begin_;
  std::optional<DriveTracker> tracker_;
  std::vector<std::string> notes_;
};

/// A tracked drive.
struct DriveTracking {
  TrackedDrive drive;
  bool interrupted = false;
};
/// Tracks the study's recording from its beginning to its end. @throws InputError when channels are missing
[[nodiscard]] DriveTracking track(const VehicleStudy& study, Progress& progress);

/// History as a recording: `C_f`, `sigma_C_f`, `held_C_f`, `suspicion_C_f`, ...
[[nodiscard]] Recording history_recording(const DriveTracker& tracker);

}  // namespace veridyn::vehicle
