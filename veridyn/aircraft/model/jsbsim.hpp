#pragma once

#include <string>

#include "veridyn/aircraft/model/subject.hpp"

namespace veridyn::aircraft {

/// The subject as a JSBSim aircraft file (`fdm_config` 2.0): metrics, mass balance, flight control, aerodynamics,
/// thrust.
///
/// What stands where:
/// - every parameter is a separate function, `aero/coefficient/CL_alpha`; `aero/coefficient/CL` and its like are
///   their sums with the stall blend. Forces are given along X, Y, Z and moments along ROLL, PITCH, YAW, all body axes:
///   JSBSim's LIFT and DRAG are wind axes that turn with sideslip, ours (see `aero_loads`) do not;
/// - the centre of gravity is the origin of JSBSim's structural frame (x aft, y right, z up); AERORP is
///   `Subject::force_point`. JSBSim's `ixz` enters its inertia matrix with a plus, so it is -Jxz of `Inertia`;
/// - thrust and its torque are external reactions of `fcs/engine-throttle-norm` (0..1), which a script sets, so that
/// any
///   of our propulsion models fits without an engine file; a rotor's lag is a filter of that throttle;
/// - `fcs/elevator-cmd-norm`, `aileron-`, `rudder-` (-1..1) move the surfaces between their stops through lag, rate
///   limit and delay. Deflections keep the subject's sign convention, which the file's header repeats.
///
/// Numbers are written with 17 digits and SI units where JSBSim allows them; functions are in JSBSim's units (feet,
/// pounds, slugs). Ground contacts, which JSBSim wants, are four points at nose, tail and tips, placed by the span. Not
/// exported: gusts' rates, the lag of the downwash, free play, sensors, what a recording holds as `thrust`.
/// @throws InputError when a parameter of the model has no value, or there is no inertia: JSBSim cannot fly either.
[[nodiscard]] std::string write_jsbsim(const Subject& subject);

}  // namespace veridyn::aircraft
