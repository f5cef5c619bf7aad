#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/estimate.hpp"
#include "veridyn/vehicle/identification/drive_log.hpp"
#include "veridyn/vehicle/identification/drive_segments.hpp"
#include "veridyn/vehicle/tracking/drive_tracker.hpp"
#include "veridyn/vehicle/identification/vehicle_identification.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"

namespace veridyn::vehicle {

/// A study of one vehicle's recorded drive, read and checked.
///
///     seed = 1
///     [subject]    kind = "vehicle", name = "...", and numbers of kVehicleFields: mass, a and b are needed; C_f, C_r
///                  and I_z are where the search begins (I_z: m a b when it is not given; stiffnesses: 20 times the
///                  static load per rad, or from the equation error)
///     [data]       see read_drive_log          [signals]   see DriveSignalOptions
///     [segments]   see DriveSegmentOptions     [identify]  see VehicleIdentifyOptions
///     [track]      see DriveTrackOptions       [validate]  `segments = "all"` (default) or "holdout": where an
///     estimate
///                                                          of other data is tried
struct DriveStudy {
  std::string name;
  std::uint64_t seed = 0;
  std::string subject_name;
  VehicleParameters<double> vehicle;  ///< mass, a, b as given; C_f, C_r, I_z a start
  DriveLog log;
  DriveSignalOptions signals;
  DriveSegmentOptions segments;
  VehicleIdentifyOptions identify;
  DriveTrackOptions track;
  bool validate_on_holdout_only = false;
  std::vector<std::filesystem::path> inputs;  ///< files that were read
  std::vector<std::string> notes;
};

/// Reads every table of the study and its recording. Tables `[drive]`, `[road]` and `[sensors]` are left for the
/// simulation (the caller refuses unknown keys with `study.root().finish()` once everybody has read).
/// @throws InputError for anything that is wrong in either.
[[nodiscard]] DriveStudy read_drive_study(const Study& study, Progress& progress);

/// The same with a recording at hand (a simulated one) instead of `[data] file`; `[data.map]` and `frame` still count.
[[nodiscard]] DriveStudy read_drive_study(const Study& study, const Recording& recording, Progress& progress);

/// Everything that became of a drive.
struct DriveAnalysis {
  DriveSignals signals;
  DriveSegments segments;
  VehicleIdentification identification;
  estimation::Estimate estimate;
  bool interrupted = false;
};

/// The whole way: signals, segments, equation error, output error, hold-out, verdict.
/// @throws InputError when a channel that it needs is missing, or the vehicle never drives.
[[nodiscard]] DriveAnalysis identify_drive(DriveStudy& study, Progress& progress);

/// An estimate against the drive of a study, which it has not seen: `identification.validation` and the verdict are
/// new, parameters are those of the estimate.
[[nodiscard]] DriveAnalysis validate_drive(DriveStudy& study, const estimation::Estimate& estimate, Progress& progress);

/// A drive followed on line, from a whole recording or one that is still being written: both ways take the same samples
/// of the same grid (whole multiples of its step), so the result does not depend on the pieces.
class TrackedDrive {
 public:
  explicit TrackedDrive(const DriveStudy& study);

  /// Takes what the recording holds beyond what was taken before. `finished`: nothing will follow.
  /// @return the changes found. @throws InputError when channels are missing
  std::vector<DriveChange> advance(const recording::MappedRecording& mapped, bool finished, Progress& progress);

  /// Null before the first second of the drive: noise and rate are learned from it.
  [[nodiscard]] const DriveTracker* tracker() const { return tracker_ ? &*tracker_ : nullptr; }
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
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

struct DriveTracking {
  TrackedDrive drive;
  bool interrupted = false;
};
[[nodiscard]] DriveTracking track_drive(DriveStudy& study, Progress& progress);

/// History as a recording: `C_f`, `sigma_C_f`, `held_C_f`, `suspicion_C_f`, ...
[[nodiscard]] Recording history_recording(const DriveTracker& tracker);

}  // namespace veridyn::vehicle
