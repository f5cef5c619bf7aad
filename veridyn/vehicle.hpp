#pragma once

/// From a drive log to a vehicle model, simulated drives, scaled vehicles.
///
///     vehicle::read_study(study, progress)        // read: the vehicle, its recording, what to do
///     vehicle::identify(drive, progress)          // stiffnesses, yaw inertia, understeer gradient, verdict, evidence
///     vehicle::validate(other, estimate, ...)     // does the estimate predict another drive?
///     vehicle::track(drive, progress)             // on line, with an alarm at changes; TrackedDrive as it grows
///     vehicle::estimated_vehicle(...)             // the vehicle that an estimate describes; export: write_tir
///     vehicle::read_simulation_study(...)         // a manoeuvre on a road, and
///     vehicle::run_simulation_study(...)          // driven: trajectory, what sensors record, metrics
///     vehicle::read_scale_study, run_scale_study  // a dynamically similar car of another size; scale, compare
///
/// Without a study: `builtin_vehicle` is a car, `step_steer` and its like what the driver does, `simulate` a drive,
/// `record_drive` what sensors make of it, `identify_parameters` the estimate alone. Component `vehicle`.

#include "veridyn/io.hpp"
#include "veridyn/vehicle/drive_sensitivity.hpp"
#include "veridyn/vehicle/identification/fit/estimated_vehicle.hpp"
#include "veridyn/vehicle/model/bicycle_model.hpp"
#include "veridyn/vehicle/model/builtin_vehicles.hpp"
#include "veridyn/vehicle/scale_study.hpp"
#include "veridyn/vehicle/simulation/trajectory_table.hpp"
#include "veridyn/vehicle/simulation_study.hpp"
#include "veridyn/vehicle/track_drive.hpp"
#include "veridyn/vehicle/tyre/linear_tyre.hpp"
#include "veridyn/vehicle/tyre/tir_reader.hpp"
#include "veridyn/vehicle/tyre/tir_writer.hpp"
#include "veridyn/vehicle/vehicle_study.hpp"
