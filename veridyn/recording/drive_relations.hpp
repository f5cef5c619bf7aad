#pragma once

#include <vector>

#include "veridyn/recording/consistency.hpp"

namespace veridyn::recording {

/// Ratios of steering gears from racing karts to trucks.
inline constexpr double kLeastSteeringRatio = 3.0, kMostSteeringRatio = 40.0;

/// The relations that the channels of a drive allow (see check_consistency); what the recording lacks is left out.
[[nodiscard]] std::vector<ChannelRelation> drive_relations(const DriveMotion& motion,
                                                           const ConsistencyOptions& options);

}  // namespace veridyn::recording
