#pragma once

#include <span>

#include "veridyn/estimation/judgement/evidence.hpp"
#include "veridyn/vehicle/identification/options/vehicle_identify_options.hpp"
#include "veridyn/vehicle/identification/signals/drive_segments.hpp"
#include "veridyn/vehicle/identification/signals/drive_signals.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"

namespace veridyn::vehicle {

/// View of what identification is given. Mass, a and b of `start` are known; C_f, C_r, I_z are where the search begins.
struct VehicleProblem {
  const DriveSignals& signals;
  const DriveSegments& segments;
  const VehicleParameters<double>& start;
  const DriveSignalOptions& signal_options;
  const VehicleIdentifyOptions& options;
  /// What was found of the recording: rows that bear on the estimate too.
  std::span<const estimation::Evidence> recording = {};
};

}  // namespace veridyn::vehicle
