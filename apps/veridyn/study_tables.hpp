#pragma once

#include "veridyn/core/study.hpp"

namespace veridyn::app {

// A study serves several commands. One that does not use the tables of the others reads them all the same, by the
// domain's readers, so that a misspelt key is refused whichever command meets it first. `[data]` is only read by the
// commands that open the recording, which need not be there yet.

/// The tables of an aircraft's study that say how its flight is analysed. @throws InputError for a wrong value.
void check_flight_tables(const StudyTable& root);

/// The tables of a vehicle's study that say how its drive is recorded, analysed and scaled. @throws InputError for a
/// wrong value.
void check_drive_tables(const StudyTable& root);

}  // namespace veridyn::app
