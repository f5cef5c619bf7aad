#pragma once

#include "veridyn/core/progress.hpp"
#include "veridyn/core/study.hpp"

namespace veridyn::app {

// A study serves several commands. One that does not use the tables of the others reads them all the same, by the
// domain's readers, so that a misspelt key is refused whichever command meets it first. Of `[data]` only the keys are
// read: the recording need not be there yet.

/// Reads the tables of an aircraft's study that say how its flight is analysed, then refuses unknown keys.
/// @throws InputError for a wrong value or an unknown key.
void finish_flight_study(const StudyTable& root);

/// Tables of a vehicle's study that a command reads for its work.
enum class DriveTables {
  kNone,
  kSimulation,  ///< [drive], [road], [sensors]
  kScale        ///< these and [scale]
};

/// Reads the tables of a vehicle's study that say how its drive is simulated, recorded, analysed and scaled, then
/// refuses unknown keys. Where the study names a recording, a drive that cannot be simulated does not matter:
/// identifying a vehicle takes fewer parameters than driving it.
/// @param read what the command has read itself, with its roads and recorded steering: it is not read again
/// @throws InputError for a wrong value or an unknown key.
void finish_drive_study(const StudyTable& root, const Progress& progress, DriveTables read = DriveTables::kNone);

/// Whether a vehicle's study names a recording of a drive.
[[nodiscard]] bool names_recording(const StudyTable& root);

}  // namespace veridyn::app
