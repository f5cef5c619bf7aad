#pragma once

#include <optional>
#include <string>
#include <vector>

#include "veridyn/camera/calibration/fit_camera.hpp"
#include "veridyn/core/check_outcome.hpp"
#include "veridyn/report/document/document.hpp"

namespace veridyn::app {

/// A calibration for people: what decides whether it may be used, its residuals as arrows on the track, and the
/// parameters with their standard errors.
[[nodiscard]] report::Document calibration_report(const camera::CalibrationPoints& points,
                                                  const camera::Calibration& calibration,
                                                  const std::optional<camera::HeldOut>& held_out,
                                                  const std::vector<CheckOutcome>& checks,
                                                  const std::string& generator);

}  // namespace veridyn::app
