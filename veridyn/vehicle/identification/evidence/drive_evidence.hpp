#pragma once

#include <optional>
#include <span>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/recording/delays.hpp"
#include "veridyn/vehicle/identification/evidence/drive_consistency.hpp"
#include "veridyn/vehicle/identification/signals/drive_segments.hpp"
#include "veridyn/vehicle/identification/signals/drive_signals.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"

namespace veridyn::vehicle {

/// What the recording of a drive says of itself, before any model.
struct DriveFindings {
  std::vector<estimation::Evidence> rows = {};  ///< which no model changes
  DriveConsistency consistency = {};
  std::optional<recording::DelayReport> steering_delay = {};  ///< by signals; nothing without steering
  VehicleParameters<double> vehicle = {};                     ///< mass, a and b are taken as given
  double gravity = kGravity;
};

/// Does the recording of a drive agree with itself and with physics? The samples, what the channels say of each
/// other (`drive_consistency`), a steering that stands still in a turn, the order in time.
[[nodiscard]] DriveFindings drive_findings(const recording::MappedRecording& mapped, const DriveSignals& signals,
                                           const DriveSegments& segments, const VehicleParameters<double>& vehicle,
                                           const DriveSignalOptions& options, const Progress& progress);

/// Whether it contradicts itself, whatever a model would say, in what parameters rest on.
[[nodiscard]] bool contradicts_itself(const DriveFindings& findings);

/// How late the identified vehicle answers the recorded steering, which its model corrects.
struct DelayByModel {
  double value_s = 0.0, sigma_s = 0.0;
};

/// What the model of a drive knows of its recording.
struct KnownByModel {
  /// How far the body leans. The structure with roll is taken only where it explains the drive better than a wrong
  /// scale of the accelerometer does.
  std::optional<double> roll_gradient = {};
  /// What compares signals alone takes a body's lean, or noise of slow steering, for a delay.
  std::optional<DelayByModel> delay = {};
  bool changed = false;  ///< the vehicle did not stay what it was, so that signals alone show no delay
};

/// Whether something that parameters rest on is with care at least, the order in time left aside: of flawed channels a
/// model takes up what it can, as a delay.
[[nodiscard]] bool is_in_doubt(const DriveFindings& findings, const KnownByModel& known);

/// The rows of a drive; and, "not verified", of what no drive shows: mass and the place of the centre of gravity.
[[nodiscard]] std::vector<estimation::Evidence> recording_rows(const DriveFindings& findings,
                                                               const KnownByModel& known = {});

/// The row of the delay between steering, turning and accel_y: by the model where that says it, else by signals, which
/// never verify it.
[[nodiscard]] estimation::Evidence steering_row(const recording::DelayReport& by_signals, const KnownByModel& known);

/// How late the yaw acceleration follows the steering, where the drive shows it.
[[nodiscard]] recording::DelayReport steering_delay(const DriveSignals& signals, std::span<const TimeSpan> spans,
                                                    const Progress& progress);

}  // namespace veridyn::vehicle
