#pragma once

#include <map>
#include <string>
#include <vector>

#include "veridyn/aircraft/model/subject.hpp"

namespace veridyn::aircraft {

/// What a file says of its numbers.
struct JsbsimNotes {
  std::vector<std::string> header = {};                ///< of the whole, a note each
  std::map<std::string, std::string> parameters = {};  ///< by name: where the value is from
};

/// The subject as a JSBSim aircraft file (`fdm_config` 2.0): metrics, mass balance, flight control, aerodynamics,
/// thrust.
///
/// What stands where:
/// - every parameter is a separate function, `aero/coefficient/CL_alpha`; `aero/coefficient/CL` and its like are
///   their sums with the stall blend. Forces are given along X, Y, Z and moments along ROLL, PITCH, YAW, all body axes:
///   JSBSim's LIFT and DRAG are wind axes that turn with sideslip, ours (see `aero_loads`) do not;
/// - the centre of gravity is the origin of JSBSim's structural frame (x aft, y right, z up); AERORP is
///   `Subject::force_point`. JSBSim's `ixz` enters its inertia matrix with a plus, so it is -Jxz of `Inertia`;
/// - thrust and its torque are external reactions of the throttle, so that any of our propulsion models fits. JSBSim
///   gives a throttle (`fcs/throttle-cmd-norm`, 0..1), and its trim moves it, only where there is an engine: the file
///   has one of its own without power. A rotor's lag is a filter of the throttle;
/// - `fcs/elevator-cmd-norm`, `aileron-`, `rudder-` (-1..1), each with the pilot's trim (`fcs/pitch-trim-cmd-norm`,
///   `roll-`, `yaw-`), which `simulation/do_simple_trim` moves, move the surfaces between their stops through lag, rate
///   limit and delay. Deflections keep the subject's sign convention, which the file's header repeats.
///
/// Numbers are written with 17 digits and SI units where JSBSim allows them; functions are in JSBSim's units (feet,
/// pounds, slugs). Ground contacts, which JSBSim wants, are four points at nose, tail and tips, placed by the span. Not
/// exported: gusts' rates, the lag of the downwash, free play, the throttle's lag, sensors, what a recording holds as
/// `thrust`.
/// @throws InputError when a parameter of the model has no value, or there is no inertia: JSBSim cannot fly either;
/// `complete_subject` gives them.
[[nodiscard]] std::string write_jsbsim(const Subject& subject, const JsbsimNotes& notes = {});

}  // namespace veridyn::aircraft
