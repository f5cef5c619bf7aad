#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/estimation/result/parameter.hpp"
#include "veridyn/recording/delays.hpp"
#include "veridyn/vehicle/identification/evidence/drive_consistency.hpp"
#include "veridyn/vehicle/identification/signals/drive_segments.hpp"
#include "veridyn/vehicle/identification/signals/drive_signals.hpp"

namespace veridyn::vehicle {

/// Does the recording of a drive agree with itself and with physics? Rows of the samples, of the relations between the
/// sensors (`drive_relations`), of gravity, of a steering that stands still in a turn, of the order in time; and, "not
/// verified", of what no drive shows: mass and the place of the centre of gravity.
[[nodiscard]] std::vector<estimation::Evidence> drive_evidence(
    const recording::MappedRecording& mapped, const DriveSignals& signals, const DriveSegments& segments,
    const VehicleParameters<double>& vehicle, const DriveSignalOptions& options, const Progress& progress);

/// The rows of the relations: which sensor is wrong and by how much, where one alone explains what is off.
[[nodiscard]] std::vector<estimation::Evidence> relation_rows(std::span<const DriveRelation> relations,
                                                              bool gravity_removed, double gravity);

/// The row of the lateral acceleration against turning, passed where the roll gradient of the identified model explains
/// it; any other as it is. `roll_gradient` may be null. The structure with roll is taken only where it explains the
/// drive better than a wrong scale of the accelerometer does.
[[nodiscard]] estimation::Evidence explained_by_roll(estimation::Evidence row,
                                                     const estimation::Parameter* roll_gradient, double gravity);

/// The row of the order in time.
inline constexpr std::string_view kOrderInTime = "order in time";

/// The row of the order in time by the delay of the steering that the identified model finds when it is left free; any
/// other row, or without a delay, as it is. What compares signals alone takes a body's lean, or noise of slow steering,
/// for a delay.
[[nodiscard]] estimation::Evidence in_time_of_model(estimation::Evidence row, const estimation::Parameter* steer_delay);

/// How late the yaw acceleration follows the steering, where the drive shows it.
[[nodiscard]] recording::DelayReport steering_delay(const DriveSignals& signals, std::span<const TimeSpan> spans,
                                                    const Progress& progress);

}  // namespace veridyn::vehicle
