#pragma once

namespace veridyn::app {

/// What `veridyn init vehicle` writes; "@DATA@" stands for the lines of the log; see `with_keys` for those of `@keys`.
constexpr const char* kVehicleStudy = R"toml(# A study of a road vehicle: drive it, identify it from a log, scale it.
#   veridyn simulate study.toml         drives the manoeuvre below, with a report
#   veridyn identify study.toml         from a drive log to parameters with error bars, validated on held-out data;
#                                       without a log the drive below is simulated and its truth shown alongside
#   veridyn sensitivity study.toml      which number of the vehicle moves which result of the drive below, without a log
#   veridyn track study.toml            follows cornering stiffnesses on line, replayed or --live
#   veridyn scale study.toml            the same vehicle in another size, and how similar a model is
# Numbers are SI and radians; a text may carry any unit of the same kind: "80 km/h", "12 deg". Keys with a leading # show
# their defaults. Misspelt keys are refused, with the nearest known one. Axes after ISO 8855: x forward, y left, z up.

title = "my car"
seed = 1

[subject]
kind = "vehicle"
name = "my car"
# builtin = "reference"            # or "saloon", "reference_1to5": start from it; every key below overrides it
mass = @MASS@                   # whole vehicle
a = @A@                       # centre of gravity to front axle
b = @B@                       # to rear axle
I_z = 2350                         # kg m^2, yaw. For identification where the search begins, as C_f and C_r
C_f = "58000 N/rad"                # cornering stiffness of ONE tyre
C_r = "65000 N/rad"
# Only the four-wheel model needs these:
unsprung_mass = "38 kg"            # what moves with one wheel
track = "1.53 m"                   # or track_f, track_r
cg_height = "0.55 m"
I_x = 540                          # roll and pitch inertia of the sprung mass
I_y = 2150
K_s = 19000                        # N/m, spring of one corner (K_sf, K_sr); dampers C_s; anti-roll bars K_b
C_s = 1650                         # N s/m
K_b = 4000
K_t = 210000                       # N/m, vertical stiffness of one tyre
mu = 0.95                          # friction limit; left out: none
tyre = "fiala"                     # "linear", "magic formula", or a tyre file: "car.tir"
# [subject.tyres]                  # tyre files of the axles, or shape of the magic formula; see docs/vehicle.md
# front = "front.tir"
# rear = "rear.tir"
# [subject.longitudinal]           # for longitudinal = true below
# front_drive_share = 1.0
# wheel_radius = "0.31 m"

[drive]
model = "four-wheel"               # "bicycle", "linear bicycle"
speed = "80 km/h"
manoeuvre = "step steer"           # "reference", "sine", "sine with dwell", "sweep", "random steer", "fishhook",
                                   # "steady-state circle", "double lane change", "obstacle avoidance", "slalom",
                                   # "ramp steer", "braking in a turn", "follow path", "signal"
amplitude = "2 deg"                # at the road wheels
duration = 10
# longitudinal = false             # true: drive, brake, drag, grade
# gravity = 9.80665

# [road]
# kind = "iso8608"                 # "step", "ramp", "bump", "plank", "file" (CSV or OpenCRG)
# class = "B"

[sensors]
set = "reference"                  # production-car sensors; "perfect"
# accel_position = [0, 0, 0]       # m from the centre of gravity: forward, left, up

# ---- A recorded drive ------------------------------------------------------------------------------------------------
@DATA@
[signals]
@keys signals steering_ratio roll_gradient accel_position pass_band

[segments]
@keys segments min_speed min_lateral_acceleration holdout

[identify]
@keys identify method structure tyre estimate profiles
# [identify.uncertainty]           # how well what is taken as known is known
@keys identify.uncertainty mass a steer_scale

[validate]
@keys validate segments open_loop

[track]
@keys track memory false_alarm_interval

# ---- Another size ----------------------------------------------------------------------------------------------------
[scale]
length_ratio = 0.2                 # any of length_ratio, mass, speed
# mass = "12 kg"
# speed = "5 m/s"
# froude = false                   # true: speed by the square root, so that weight scales too
# [scale.model]                    # a scaled vehicle to be checked: keys of [subject], and its speed
# builtin = "reference_1to5"
)toml";

constexpr const char* kNoDriveLog = R"toml(# [data]
# file = "drive.csv"               # CSV, MAT, NumPy folder, ...: `veridyn inspect` lists the channels
# frame = "flu"                    # x forward, y left, z up; "frd": y right, z down
# [data.map]                       # channels with the names steer, speed, yaw_rate, accel_y need no mapping
# steering_wheel = { channel = "SteeringAngle", unit = "deg" }
# yaw_rate = { channel = "GyroZ", unit = "deg/s" }
)toml";

constexpr const char* kDriveLog = R"toml([data]
file = @LOG@
@READ@# frame = "flu"                    # x forward, y left, z up; "frd": y right, z down
[data.map]                         # channels with the names steer, speed, yaw_rate, accel_y need no mapping
@MAP@# steering_wheel = { channel = "SteeringAngle", unit = "deg" }
# yaw_rate = { channel = "GyroZ", unit = "deg/s" }
)toml";

}  // namespace veridyn::app
