#pragma once

namespace veridyn::app {

/// What `veridyn init cueing` writes; "@DATA@" stands for the drive; see `with_keys` for lines of `@keys`.
constexpr const char* kCueingStudy =
    R"toml(# A study of a drive on a motion platform: which algorithm feels most like it, and what the platform does.
#   veridyn cue study.toml              report.html: what is felt, false cues, workspace, gain and phase
# Numbers are SI and radians; a text may carry any unit of the same kind: "3 deg/s", "120 mm". Keys with a leading # show
# their defaults. Misspelt keys are refused, with the nearest known one. docs/cueing.md explains each knob by its feel.

title = "my drive on my platform"
seed = 1

[cue]
algorithms = ["tilt", "classical", "three_axis", "return", "optimal", "adaptive"]  # also "fuzzy", "moving_origin", "mpc"
driver = [0.2, 0.35, 0.5]          # driver's head from the centre of gravity: forward, left, up [m]
@keys cue sensor gravity preset perception thresholds foresee
# [cue.lap]                        # a lap of the same track, driven before; positions are needed in both
# file = "lap.csv"

[platform]
subject = "three_axis"             # "hexapod"; or limits of your own:
# roll = ["-20 deg", "20 deg"]
# roll_rate = "30 deg/s"
# roll_acceleration = "200 deg/s^2"
# heave = [-0.1, 0.1]
# heave_rate = 0.3
# heave_acceleration = 3
@keys platform omega delay rider

@DATA@
# [washout.classical]              # numbers of one algorithm
@keys washout.classical force_gain tilt_rate

# [omct]                           # gain and phase of the whole chain
# frequencies = [0.25, 0.63, 1.6, 4.0, 10.0]
# [[omct.mask]]
# cue = "sway"
# frequency = [0.3, 8.0]
# least_gain = [0.2, 0.02]

# [tune]                           # turn the knobs first, on this drive
@keys tune evaluations
# [tune.data]                      # or on another one
# file = "other.csv"
)toml";

/// The drive, simulated.
constexpr const char* kCueingSimulated = R"toml([subject]
kind = "vehicle"
builtin = "reference"

[drive]                            # or [data] with file = "drive.csv"
model = "four-wheel"
manoeuvre = "double lane change"
speed = "80 km/h"
)toml";

/// The drive, recorded.
constexpr const char* kCueingRecorded = R"toml([data]
file = @LOG@
@READ@# frame = "flu"                    # x forward, y left, z up; "frd": y right, z down
[data.map]                         # `veridyn inspect` lists what the log has
@MAP@# accel_x = "IMU.ax"
# accel_y = "IMU.ay"
# accel_z = "IMU.az"
# gyro_z = { channel = "yaw_rate", unit = "deg/s" }
)toml";

}  // namespace veridyn::app
