#pragma once

/// From a flight log to an aerodynamic model.
///
///     aircraft::read_study(study, progress)       // read: the aircraft, its recording or a simulated flight
///     aircraft::reconstruct(flight, progress)     // airspeed, flow angles and wind with their bands
///     aircraft::identify(flight, progress)        // coefficients with error bars, verdict, evidence
///     aircraft::validate(other, estimate, ...)    // does the estimate predict another flight?
///     aircraft::track_flight(flight, progress)    // on line, with an alarm at changes; TrackedFlight as it grows
///     aircraft::write_jsbsim(analysis.identified) // export; to_json(subject), io::to_json(estimate)
///     aircraft::complete_subject(...)             // what is not known: study, estimates, zero; fly_trial, jsbsim_file
///
/// `flight_modes` of a subject are its natural modes, `derived_modes` those of an estimate with their intervals.
///
/// Without a study: `builtin_subject` is an aircraft, `simulate_study` a flight of one, `identify_coefficients` and
/// `reconstruct(recording, ...)` the stages by themselves; `analyse_swing_test` (inertia) and `calibrate` (air
/// data) are for the ground. Component `aircraft`.

#include "veridyn/aircraft/aircraft_study.hpp"
#include "veridyn/aircraft/export/jsbsim_export.hpp"
#include "veridyn/aircraft/flight_sensitivity.hpp"
#include "veridyn/aircraft/flying_qualities/derived_modes.hpp"
#include "veridyn/aircraft/identification/identified_estimate.hpp"
#include "veridyn/aircraft/model/builtin_subjects.hpp"
#include "veridyn/aircraft/model/estimated_subject.hpp"
#include "veridyn/aircraft/model/jsbsim.hpp"
#include "veridyn/aircraft/sensors/air_data_calibration.hpp"
#include "veridyn/aircraft/sensors/swing_test.hpp"
#include "veridyn/aircraft/simulation/simulate_study.hpp"
#include "veridyn/aircraft/track_flight.hpp"
#include "veridyn/io.hpp"
