#pragma once

#include "veridyn/vehicle/identification/options/vehicle_identify_options.hpp"
#include "veridyn/vehicle/identification/signals/drive_segments.hpp"
#include "veridyn/vehicle/identification/signals/drive_signals.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"

namespace veridyn::vehicle {

struct DriveFindings;  // drive_evidence.hpp

/// View of what identification is given. Mass, a and b of `start` are known; C_f, C_r, I_z are where the search begins.
struct VehicleProblem {
  const DriveSignals& signals;
  const DriveSegments& segments;
  const VehicleParameters<double>& start;
  const DriveSignalOptions& signal_options;
  const VehicleIdentifyOptions& options;
  const DriveFindings* recording = nullptr;  ///< what the recording says of itself; null: it was not looked at
};

}  // namespace veridyn::vehicle
