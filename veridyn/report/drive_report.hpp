#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "veridyn/report/document/document.hpp"
#include "veridyn/vehicle/vehicle_study.hpp"

namespace veridyn::report {

/// What a drive report is to say besides the analysis.
struct DriveReportContext {
  std::string program;
  bool validation_only = false;  ///< an estimate of other data was validated
};

/// The speed at which a drive's frequency response is shown [m/s]: the mean of what was driven faster than 3 m/s; of a
/// slower drive the mean of what was moving (above 0.1 m/s); none when it stood or has no speed.
[[nodiscard]] std::optional<double> response_speed(std::span<const double> speed);

/// The report of `veridyn identify` (and `validate`) of a vehicle: verdict, parameters by method with intervals,
/// measured and predicted motion on held-out data, path, g-g diagram, understeer diagram, frequency response.
[[nodiscard]] Document drive_report(const vehicle::VehicleStudy& study, const vehicle::VehicleAnalysis& analysis,
                                    const DriveReportContext& context);

}  // namespace veridyn::report
