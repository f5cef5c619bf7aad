#pragma once

namespace veridyn::app {

/// What `veridyn init swing-test` writes.
inline constexpr const char* kSwingTestStudy =
    R"toml(# Inertia from swing tests: the aircraft (in its cradle) hangs, is pushed, and its swing is recorded.
#   veridyn identify study.toml         from recordings to inertia with error bars: report.html, subject.toml
# Bifilar: from two parallel lines, turning about the vertical. Pendulum: swinging about a pivot. Swing gently (10 deg),
# several times, and let it swing for a minute; then the cradle alone.
# Numbers are SI; a text may carry any unit of the same kind: "27 lb", "2 mm". Keys with a leading # show their defaults.

seed = 1

[swing_test]
name = "my aircraft"
mass = "? kg"                    # of the aircraft alone
cradle_mass = "? kg"             # 0: it hung without one, then leave out the cradle's keys
# channel = "roll"               # the recorded angle; without: quaternion qx, qy, qz, qw, or a channel `angle`
# settle = "0 s"                 # leave out this long after the largest excursion
# fade = 0.1                     # and what comes after the swing has faded to this share
# max_relative_sigma = 0.1       # worse known is not determined
# draws = 100000

[swing_test.sigma]               # standard errors of what you measured by hand
mass = "2 gram"
filar_distance = "2 mm"
length = "5 mm"

[swing_test.x]                   # the body axis that it turned about; likewise y, z; each is optional
suspension = "bifilar"
filar_distance = "? m"           # between the lines
length = "? m"                   # of the lines, with the aircraft
cradle_length = "? m"            # of the lines, cradle alone
files = ["aircraft_x_1.csv", "aircraft_x_2.csv", "aircraft_x_3.csv"]
cradle_files = ["cradle_x_1.csv", "cradle_x_2.csv"]

[swing_test.y]
suspension = "pendulum"
length = "? m"                   # pivot to the centre of gravity of aircraft and cradle
cradle_length = "? m"            # pivot to the centre of gravity of the cradle
offset = "? m"                   # how much further from the pivot the aircraft's centre of gravity is
files = ["aircraft_y_1.csv", "aircraft_y_2.csv"]
cradle_files = ["cradle_y_1.csv", "cradle_y_2.csv"]

[swing_test.z]
suspension = "bifilar"
filar_distance = "? m"
length = "? m"
cradle_length = "? m"
files = ["aircraft_z_1.csv", "aircraft_z_2.csv"]
cradle_files = ["cradle_z_1.csv", "cradle_z_2.csv"]
)toml";

/// What `veridyn init calibration` writes.
inline constexpr const char* kCalibrationStudy =
    R"toml(# Calibration of air-data sensors from wind-tunnel points: scale, bias and their covariance.
#   veridyn identify study.toml         report.html, residuals.csv, and calibration.toml, which a flight's study applies:
#                                       [data] calibration = "calibration.toml"
# The table is CSV with a header name[unit], a row a point, in the order in which they were taken: go up and come down
# again, so that hysteresis shows. Keys with a leading # show what else there is.

[calibration]
name = "my air-data boom"
file = "tunnel.csv"

[calibration.dynamic_pressure]
raw = "dp_raw"                   # column of the sensor's reading
reference_speed = "V_ref"        # the tunnel's speed, with the density from
static_pressure = "p"            #   columns of static pressure and temperature,
air_temperature = "T"
# air_density = 1.2              #   or a number; or give the dynamic pressure itself: reference = "q_ref"
# sigma_reference = "0.5 Pa"     # standard errors per point; both given: total least squares
# sigma_raw = "2 Pa"

[calibration.alpha]              # the scale of a vane is its upwash slope
raw = "alpha_raw"
reference = "alpha_ref"

[calibration.beta]
raw = "beta_raw"
reference = "beta_ref"

# [calibration.static_pressure]  # likewise air_temperature, airspeed
# raw = "p_raw"
# reference = "p"
)toml";

}  // namespace veridyn::app
