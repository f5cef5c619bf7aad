#pragma once

#include <optional>
#include <vector>

#include "veridyn/core/study.hpp"
#include "veridyn/estimation/open_loop/open_loop.hpp"
#include "veridyn/vehicle/identification/options/drive_model_options.hpp"

namespace veridyn::vehicle {

/// What is driven open loop in validation. Keys of the study table `[validate]`.
struct DriveOpenLoopOptions {
  estimation::OpenLoopTimes times = {};  ///< `open_loop`, `open_loop_start`
  /// `open_loop_offsets`: biases (of steering and sensors) that have a constant of their own in each window, estimated
  /// with the initial state: biases belong to the day. Where it is not given: all that the estimate does not know of
  /// this drive; on another drive than its own that is all of them.
  std::optional<std::vector<DriveUnknown>> offsets = {};

  [[nodiscard]] bool asked() const { return times.duration_s > 0.0; }
  /// Takes the keys that are there. @throws InputError for values that make no sense.
  [[nodiscard]] static DriveOpenLoopOptions read(const StudyTable& table);
};

/// The biases of steering and sensors.
inline constexpr std::array<DriveUnknown, 6> kDriveBiases{DriveUnknown::kSteerBias,    DriveUnknown::kYawRateBias,
                                                          DriveUnknown::kAccelYBias,   DriveUnknown::kRollBias,
                                                          DriveUnknown::kRollRateBias, DriveUnknown::kSideslipBias};

}  // namespace veridyn::vehicle
