#pragma once

#include <optional>
#include <vector>

#include "veridyn/core/study.hpp"
#include "veridyn/estimation/open_loop/open_loop.hpp"
#include "veridyn/vehicle/identification/options/drive_model_options.hpp"

namespace veridyn::vehicle {

/// What is driven open loop in validation. Study table `[validate]`.
struct DriveOpenLoopOptions {
  estimation::OpenLoopTimes times = {};
  /// Biases that have a constant of their own in each window: they belong to the day. Nothing: all that the estimate
  /// does not know of this drive.
  std::optional<std::vector<DriveUnknown>> offsets = {};

  [[nodiscard]] bool asked() const { return times.duration_s > 0.0; }
  /// Of the table `[validate]`.
  [[nodiscard]] static const KeyTable<DriveOpenLoopOptions>& keys();
};

/// How an estimate is validated. Study table `[validate]`.
struct DriveValidateOptions {
  bool holdout_only = false;  ///< where an estimate of other data is validated
  DriveOpenLoopOptions open_loop = {};

  [[nodiscard]] static const KeyTable<DriveValidateOptions>& keys();
};

/// The biases of steering and sensors.
inline constexpr std::array<DriveUnknown, 6> kDriveBiases{DriveUnknown::kSteerBias,    DriveUnknown::kYawRateBias,
                                                          DriveUnknown::kAccelYBias,   DriveUnknown::kRollBias,
                                                          DriveUnknown::kRollRateBias, DriveUnknown::kSideslipBias};

}  // namespace veridyn::vehicle
