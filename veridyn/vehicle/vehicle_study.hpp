#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/result/estimate.hpp"
#include "veridyn/vehicle/identification/signals/drive_log.hpp"
#include "veridyn/vehicle/identification/signals/drive_segments.hpp"
#include "veridyn/vehicle/identification/validation/drive_open_loop.hpp"
#include "veridyn/vehicle/identification/vehicle_identification.hpp"
#include "veridyn/vehicle/model/vehicle_parameters.hpp"
#include "veridyn/vehicle/tracking/drive_tracker.hpp"

namespace veridyn::vehicle {

// A vehicle's pipeline: read_study -> identify or validate (its motion needs no reconstruction) -> report. Simulations
// are in `simulation_study.hpp`, following a drive on line in `track_drive.hpp`.

/// A study of one vehicle's recorded drive, read and checked.
///
///     seed = 1
///     [subject]    kind = "vehicle", name = "...", and numbers of kVehicleFields: mass, a and b are needed; C_f, C_r
///                  and I_z are where the search begins (I_z: m a b when it is not given; stiffnesses: 20 times the
///                  static load per rad, or from the equation error)
///     [data]       see read_drive_log          [signals]   see DriveSignalOptions
///     [segments]   see DriveSegmentOptions     [identify]  see VehicleIdentifyOptions
///     [track]      see DriveTrackOptions       [validate]  see DriveValidateOptions
struct VehicleStudy {
  std::string name;
  std::uint64_t seed = 0;
  std::string subject_name;
  VehicleParameters<double> vehicle;  ///< mass, a, b as given; C_f, C_r, I_z a start
  DriveLog log;
  DriveSignalOptions signals;
  DriveSegmentOptions segments;
  VehicleIdentifyOptions identify;
  DriveTrackOptions track;
  DriveValidateOptions validation;
  std::vector<std::filesystem::path> inputs;  ///< files that were read
  std::vector<std::string> notes;
  std::map<std::string, double, std::less<>> truth;  ///< of a simulated drive, by parameter name; empty otherwise
};

/// Reads every table of the study and its recording. Tables `[drive]`, `[road]` and `[sensors]` are left for the
/// simulation (the caller refuses unknown keys with `study.root().finish()` once all have read).
/// @throws InputError for anything that is wrong in either.
[[nodiscard]] VehicleStudy read_study(const Study& study, Progress& progress);

/// The same with a recording at hand (a simulated one) instead of `[data] file`; `[data.map]` and `frame` still count.
[[nodiscard]] VehicleStudy read_study(const Study& study, const Recording& recording, Progress& progress);

/// What identification or validation made of a drive.
struct VehicleAnalysis : estimation::Analysis {
  DriveSignals signals;
  DriveSegments segments;
  VehicleIdentification identification;
  DriveOpenLoop open_loop;  ///< where the study asks for it
};

/// The full pipeline: signals, segments, equation error, output error, hold-out, open loop where asked for, verdict.
/// @throws InputError when a channel that it needs is missing, or the vehicle never drives.
[[nodiscard]] VehicleAnalysis identify(const VehicleStudy& study, Progress& progress);

/// An estimate validated on the drive of a study, held-out data to it: `identification.validation` and the verdict are
/// new, parameters are those of the estimate.
[[nodiscard]] VehicleAnalysis validate(const VehicleStudy& study, const estimation::Estimate& estimate,
                                       Progress& progress);

}  // namespace veridyn::vehicle
