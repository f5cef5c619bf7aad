#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/veridyn/run/domains.hpp"
#include "apps/veridyn/run/output_folder.hpp"
#include "veridyn/core/progress.hpp"
#include "veridyn/vehicle/simulation_study.hpp"
#include "veridyn/vehicle/track_drive.hpp"
#include "veridyn/vehicle/vehicle_study.hpp"

namespace veridyn::app {

/// A drive to be analysed, with the simulation that it comes from, if any.
struct PreparedDrive {
  vehicle::VehicleStudy study;
  std::optional<vehicle::SimulationRun> run;
};

/// The recorded drive of a study, or, without a recording in `[data]`, one that is simulated first (`[drive]`,
/// `[sensors]`).
/// @throws InputError when the study is wrong, Interrupted when the simulation was.
[[nodiscard]] PreparedDrive prepare_drive(const Study& study, Progress& progress);

/// Writes, publishes and prints the identification or validation of a drive.
void publish_drive(const StudyRun& run, OutputFolder& folder, const PreparedDrive& drive,
                   const vehicle::VehicleAnalysis& analysis);

}  // namespace veridyn::app
