#pragma once

#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/result/estimate.hpp"
#include "veridyn/vehicle/tracking/drive_tracker.hpp"
#include "veridyn/vehicle/vehicle_study.hpp"

namespace veridyn::vehicle {

/// A drive tracked on line, from a whole recording or one that is still being written: both ways take the same samples
/// of the same grid (whole multiples of its step), so the result does not depend on the pieces.
class TrackedDrive {
 public:
  /// @throws InputError when the estimate to begin with (`track.estimate_file`) cannot be read
  explicit TrackedDrive(const VehicleStudy& study);

  /// Takes what the recording holds beyond what was taken before. `finished`: nothing will follow.
  /// @return the changes found. @throws InputError when channels are missing
  std::vector<DriveChange> advance(const recording::MappedRecording& mapped, bool finished, Progress& progress);

  /// Null before the beginning of the drive, from which rate, noise and body are learned, is there: 20 s, or
  /// `DriveTrackOptions::learning_s` where no estimate has the body.
  [[nodiscard]] const DriveTracker* tracker() const { return tracker_ ? &*tracker_ : nullptr; }
  /// What was assumed of the signals.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
  /// As DriveTracker::estimate, judged with the rows of the recording where it has ended; without parameters before
  /// there is a tracker.
  [[nodiscard]] estimation::Estimate estimate() const;

 private:
  [[nodiscard]] bool learns_body() const;
  void begin(const recording::MappedRecording& mapped, Progress& progress);
  void check(const recording::MappedRecording& mapped, const Progress& progress);

  std::string subject_;
  VehicleParameters<double> start_;
  DriveTrackOptions options_;
  DriveSignalOptions signals_;
  DriveSegmentOptions segments_;
  VehicleIdentifyOptions identify_;
  std::optional<estimation::Estimate> begin_;
  std::optional<DriveTracker> tracker_;
  std::vector<std::string> notes_;
  std::vector<estimation::Evidence> recording_;
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
