#pragma once

#include <optional>
#include <span>
#include <vector>

#include "veridyn/core/constants.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/recording/channel_map.hpp"
#include "veridyn/recording/consistency.hpp"
#include "veridyn/vehicle/identification/signals/drive_signals.hpp"

namespace veridyn::vehicle {

/// What the channels of a drive say of each other, and what the drive calls them.
struct DriveConsistency {
  recording::Consistency found = {};
  recording::ChannelNames names = recording::DriveMotion::standard_names();
  bool gravity_removed = false;  ///< from accel_y: a body's lean is no reason for what it reads
};

/// recording::check_consistency of the signals that an identification looks at, with the vertical acceleration and the
/// course of the recording.
/// @param wheelbase [m]
[[nodiscard]] DriveConsistency drive_consistency(const recording::MappedRecording& mapped, const DriveSignals& signals,
                                                 std::span<const TimeSpan> spans, double wheelbase);

/// Its rows: what is wrong with which channel, then the relations. That of the lateral acceleration passes where the
/// lean that a model knows explains it.
/// @param roll_gradient [rad/(m/s^2)]
[[nodiscard]] std::vector<estimation::Evidence> consistency_rows(const DriveConsistency& drive,
                                                                 std::optional<double> roll_gradient = std::nullopt,
                                                                 double gravity = kGravity);

}  // namespace veridyn::vehicle
