#pragma once

#include "veridyn/report/drive_report.hpp"
#include "veridyn/vehicle/track_drive.hpp"

namespace veridyn::report {

/// The report of `veridyn track` of a vehicle.
[[nodiscard]] Document drive_tracking_report(const vehicle::VehicleStudy& study, const vehicle::TrackedDrive& drive,
                                             const DriveReportContext& context);

}  // namespace veridyn::report
