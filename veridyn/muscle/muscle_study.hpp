#pragma once

#include "veridyn/core/progress.hpp"
#include "veridyn/core/study.hpp"
#include "veridyn/muscle/study/motion_study.hpp"

namespace veridyn::muscle {

/// A muscle study is one whose `[subject]` names a `model`.
[[nodiscard]] bool is_muscle_study(const StudyTable& root);

/// Reads a study:
///
///     [subject]
///     model = "arm26.osim"           # an OpenSim model; "arm": the built-in one
///     paths = "exact"                # "fitted": polynomials, faster; "opensim": OpenSim's wrapping, jumps included
///     locked = ["r_shoulder_elev"]   # held where they start
///     unlocked = []                  # move although the model locks them
///     without_unsupported = false    # continue without forces and constraints that are not understood
///     without_contact = false        # leave the model's contacts out, because external loads have their forces
///     fiber_lengths_from = "ref.osim"  # L0 and LS with which fibres are, at the same joint angles, what those of this
///                                    # reference are (`match_fiber_lengths`): a first guess for a scaled model
///     [subject.parameters]
///     "BIClong.optimal_fiber_length" = 0.12  # also max_isometric_force, tendon_slack_length,
///                                    # pennation_angle_at_optimal, max_contraction_velocity,
///                                    # activation_time_constant, deactivation_time_constant
///     [[subject.load]]
///     body = "r_ulna_radius_hand"
///     mass = 1.0
///     location = [0, -0.31, 0.08]    # in the body's frame; its origin when left out
///
///     [motion]
///     method = "forward"             # "inverse dynamics", "static optimization", "computed muscle control"
///     begin = 0                      # [s]; of a motion file its beginning
///     duration = 1                   # [s]; of a motion file its rest
///     rate = 200                     # rows of the results [Hz]
///     accuracy = 1e-5                # of the integration: error of a step in units of the states' sizes
///     reserve_force = 1              # of an actuator that helps each free coordinate, at control 1 [N m]; 0: none
///     [motion.reserves]              # of single coordinates
///     pelvis_ty = 0
///     [motion]
///     file = "lift.mot"              # the desired motion: .mot, .sto or .csv
///     low_pass = "6 Hz"              # of its samples, without delay; none when left out
///     [[motion.ramp]]                # coordinates that the file does not have
///     coordinate = "r_elbow_flex"
///     from = "10 deg"                # where it is before; the end of the ramp before, or its start
///     to = "110 deg"
///     start = 0.03                   # [s]; `begin` when left out
///     duration = 1                   # [s]
///     shape = "minimum jerk"         # "half sine", "linear"
///     joint_reactions = "child"      # in the axes of which body of a joint: "parent", "ground"; "none" when left out
///     metabolic_cost = "umberger"    # the energy that muscles use: "bhargava"; "none" when left out
///     induced_accelerations = true   # what each muscle contributes to each acceleration; false when left out
///     external_loads = "grf.xml"     # OpenSim's ExternalLoads: forces of the surroundings, with their data
///     external_loads_data = "grf.mot"  # in place of the data file that it names
///     external_low_pass = "20 Hz"    # of all these forces, without delay; none when left out
///     [[motion.external_load]]       # or load by load
///     body = "calcn_r"
///     file = "grf.mot"
///     force = "ground_force_v"       # columns ground_force_vx, ..., or three numbers [N]
///     point = "ground_force_p"       # [m]; the body's origin when left out
///     torque = "ground_torque_"      # [N m]
///     force_frame = "ground"         # body in whose axes force and torque are
///     point_frame = "ground"
///     [motion.start]                 # pose at `begin`, and of coordinates without a motion: the model's when left out
///     r_elbow_flex = "30 deg"
///     [motion.start_speed]           # forward only
///     r_elbow_flex = 0.0
///     [motion]
///     start_file = "states.sto"      # forward: pose, speeds, activations, fibre lengths at `begin`
///     excitation_file = "controls.sto"  # forward; reserves by the name COORDINATE_reserve, in units of reserve_force
///     interpolation = "linear"       # "hold": each sample until the next
///     [motion.excitation]            # forward: constants, 0 to 1; with a file for muscles that it does not have
///     default = 0.05
///     BRA = 0.4
///     [[motion.excitation_step]]     # forward: from `time` on; muscles not named keep theirs
///     time = 0.2
///     BRA = 0.5
///     [motion.control]               # computed muscle control
///     window = 0.010                 # controls are held so long [s]
///     kp = 100                       # [1/s^2]
///     kv = 20                        # [1/s]
///     min_control = 0.02
///     max_control = 1
///     [motion.static_optimization]
///     exponent = 2
///     formulation = "with passive"   # "as opensim", "without physiology"
///
/// @throws InputError with file, line and key, of keys too that no study of muscles has.
[[nodiscard]] MuscleStudy read_study(const Study& study, Progress& progress);

}  // namespace veridyn::muscle
