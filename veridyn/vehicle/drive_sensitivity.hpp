#pragma once

#include <string>
#include <vector>

#include "veridyn/core/progress.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/estimation/uncertainty/response_indices.hpp"
#include "veridyn/vehicle/simulation_study.hpp"

namespace veridyn::vehicle {

/// A study of which number of a vehicle moves which result of a simulated drive, read and checked.
struct DriveSensitivityStudy {
  SimulationStudy drive;
  StudyTable root;  ///< of which each thread reads a driver of its own
  std::vector<estimation::IndexInput> inputs = {};
  estimation::IndexOptions options = {};
};

/// Reads the drive (`read_simulation_study`) and
///
///     [sensitivity]              # IndexOptions, GivenInputs
///
/// where what may vary are the numbers of `kVehicleFields` that are finite, and `cg_position` [m]: the distance of the
/// centre of gravity behind the front axle at the same wheelbase (a and b each change it). Without inputs: what the
/// driven model uses, with `cg_position` in place of a and b.
/// @throws InputError with file, line and key; also where an end of a range is no vehicle's.
[[nodiscard]] DriveSensitivityStudy read_drive_sensitivity(const StudyTable& root, const Progress& progress);

/// Which input moves which metric of the manoeuvre (`manoeuvre_metrics`) and which signal: root mean square difference
/// from the nominal drive over its samples. The driver does not know of the changes: steering inputs are the same, a
/// driver who follows a path expects the nominal vehicle. A drive that ends early (spun, rolled over, stopped,
/// diverged) has no result.
/// @throws InputError as `simulate`; std::runtime_error where the nominal drive ends early.
[[nodiscard]] estimation::ResponseIndices analyse_drive(const DriveSensitivityStudy& study, numerics::BlockStore& store,
                                                        Progress& progress);

}  // namespace veridyn::vehicle
