#pragma once

namespace veridyn::app {

/// What `veridyn init muscle` writes; @MODEL@ is replaced by the model's name or path; see `with_keys` for
/// lines of `@keys`.
inline constexpr const char* kMuscleStudy =
    R"toml(# A study of a musculoskeletal model: which model, which motion, what to compute.
#   veridyn inspect arm                 bodies, coordinates, muscles of a model; of your own: veridyn inspect my.osim
#   veridyn simulate study.toml         motion.csv, muscles.csv, states.sto, controls.sto, model.osim, report.html
#   veridyn identify study.toml         estimate.json, parameters.csv, tasks.csv, model.osim, report.html
# Numbers are SI and radians; a text may carry any unit of the same kind: "30 deg", "10 ms". Keys with a leading # show
# their defaults, or what they look like. Misspelt keys are refused, with the nearest known one. docs/muscle.md explains
# all of them.

[subject]
model = @MODEL@
@keys subject paths locked unlocked without_contact without_unsupported

# Parameters other than the model's: max_isometric_force, optimal_fiber_length, tendon_slack_length,
# pennation_angle_at_optimal, max_contraction_velocity (in L0/s), activation_time_constant, deactivation_time_constant.
[subject.parameters]
# "biceps_long.optimal_fiber_length" = "0.150 m"
# "biceps_long.max_isometric_force" = "550 N"

# A weight in the hand; repeat the table for more.
# [[subject.load]]
# body = "forearm"
# mass = "1 kg"
# location = [0, -0.3, 0]        # m in the body's frame

[motion]
method = "forward"               # "inverse dynamics", "static optimization", "computed muscle control"
# begin = 0                      # s; of a motion file its beginning
duration = 1                     # s; of a motion file its rest when left out
@keys motion rate accuracy reserve_force

# Where it is at `begin`, by coordinate; the model's default pose where nothing is said.
[motion.start]
# elbow_flexion = "30 deg"

# --- method = "forward": excitations are given, the motion follows -------------------------------------------------
# [motion]
# start_file = "states.sto"      # pose, speeds, activations and fibre lengths at `begin`
# excitation_file = "controls.sto"   # .sto, .mot or .csv, by the muscles' names; instead of the tables below
# interpolation = "linear"       # "hold": each sample holds until the next
[motion.start_speed]
# elbow_flexion = "0 deg/s"
[motion.excitation]              # 0 to 1
default = 0.05
# biceps_long = 0.10
# [[motion.excitation_step]]     # from `time` on; muscles that are not named keep theirs
# time = "0.2 s"
# brachialis = 0.15

# --- the three others follow a desired motion ----------------------------------------------------------------------
# [motion]
# file = "lift.mot"              # .mot, .sto or .csv with columns by the coordinates' names
# low_pass = "6 Hz"              # of its samples, without delay
# [[motion.ramp]]                # or coordinates that go from here to there; all others rest
# coordinate = "elbow_flexion"
# from = "10 deg"                # where the ramp before ended, or the start
# to = "110 deg"
# start = 0.05                   # s
# duration = 1                   # s
# shape = "minimum jerk"         # "half sine", "linear"

# external_loads = "grf.xml"     # OpenSim's ExternalLoads: forces of the surroundings during the motion, with their data
# external_low_pass = "20 Hz"    # of these forces, without delay
# [[motion.external_load]]       # or load by load
# body = "foot_r"
# file = "grf.mot"               # columns ground_force_vx, ... of:
# force = "ground_force_v"       # N
# point = "ground_force_p"       # m; the body's origin when left out
# torque = "ground_torque_"      # N m
# [motion]
# joint_reactions = "child"      # what joints transmit, in axes of "child", "parent" or "ground"
# induced_accelerations = true   # what each muscle contributes to each acceleration
# metabolic_cost = "umberger"    # the energy that muscles use; or "bhargava"

[motion.reserves]                # N m or N, of single coordinates instead of reserve_force
# pelvis_ty = 0

[motion.control]                 # computed muscle control
@keys motion.control window kp kv min_control max_control

[motion.static_optimization]
@keys motion.static_optimization exponent formulation

# --- veridyn identify study.toml: muscle parameters from motions --------------------------------------------------------
# What it estimates; without this: maximum force, optimal fibre length, tendon slack length of every muscle.
[[parameter]]
name = "strength"                # one factor of all muscles' forces
muscles = ["all"]
fields = ["max_isometric_force"]
factor = true
bounds = "20 %"
# prior = "10 %"                 # standard deviation of what is known before; else that of a value within the bounds

# Motions that it estimates from: of 42 elbow tasks by number, or of your own.
[tasks]
numbers = [8, 29]
hold_out = [12]                  # kept to validate on
# load = "1 kg"                  # in the hand
# [[task]]
# name = "trial 1"
# measured = "trial1.mot"        # recorded angles
# excitation_file = "trial1_controls.sto"   # the controls of that trial
# hold_out = false
# [task.held]
# shoulder_flexion = "0 deg"

# [identify]
@keys identify advice profiles

# A simulated person, to see what the tasks would determine. Delete it where tasks are measured.
[person]
spread = "5 %"                   # hidden parameters, within so much of the model's
noise = "0.06 deg"               # of the measured angles
)toml";

}  // namespace veridyn::app
