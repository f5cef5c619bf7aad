#pragma once

#include <string>
#include <utility>
#include <vector>

#include "veridyn/report/document/document.hpp"
#include "veridyn/vehicle/track_drive.hpp"
#include "veridyn/vehicle/vehicle_study.hpp"

namespace veridyn::report {

/// What a drive report is to say beside the analysis.
struct DriveReportContext {
  std::string program;
  /// True values by parameter name, where the drive was simulated.
  std::vector<std::pair<std::string, double>> truth = {};
  bool validation_only = false;  ///< an estimate of other data was tried
};

/// The report of `veridyn identify` (and `validate`) of a vehicle: verdict, parameters by method with intervals,
/// measured and predicted motion on data not seen, path, g-g diagram, understeer diagram, frequency response.
[[nodiscard]] Document drive_report(const vehicle::VehicleStudy& study, const vehicle::VehicleAnalysis& analysis,
                                    const DriveReportContext& context);

/// The report of `veridyn track` of a vehicle.
[[nodiscard]] Document drive_tracking_report(const vehicle::VehicleStudy& study, const vehicle::TrackedDrive& drive,
                                             const DriveReportContext& context);

}  // namespace veridyn::report
