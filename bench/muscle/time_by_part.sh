#!/bin/sh
# Where the processor time of a benchmark goes, by part of the simulation (needs perf):
#   cmake --preset bench && cmake --build --preset bench --target veridyn_muscle_bench
#   bench/muscle/time_by_part.sh build/bench/bin/veridyn_muscle_bench 'forward/thelen_s1_exact'
# Functions are assigned to parts by their names; functions of the C library that several parts call have rows of their own.
set -e
data=$(mktemp)
trap 'rm -f "$data"' EXIT
perf record -q -o "$data" "$1" --benchmark_filter="$2" --benchmark_min_time=5 >/dev/null 2>&1
perf report -i "$data" --stdio --sort symbol 2>/dev/null | awk '
  /^ *[0-9.]+%/ {
    share = $1 + 0
    if (/MuscleGroup|musculotendon|FiberSolver|Thelen|Millard|tendon_force|Activation|activation|Bezier|exp/) part = "muscle dynamics"
    else if (/PathSolver|MusclePaths|wrap|spheroid|shoot|correction|tangent_circle|newton|geodesic|Geodesic|ellipsoid|lift|internal::compute|atan2/) part = "path geometry"
    else if (/update_positions|update_velocities|turn_about/) part = "kinematics"
    else if (/Dynamics|inverse_dynamics|cross_motion|cross_force|SpatialVector|add_coordinate_forces|add_passive/) part = "multibody dynamics"
    else if (/SystemEvaluator/) part = "paths, muscles and forces brought together"
    else if (/RungeKutta|StepSizes|SystemStepper|integrate|Recorder|ControlSignals|ControlsAtInstant/) part = "integrator, controls, rows of the result"
    else if (/sincos|_sin|_cos/) part = "sine and cosine (joints and geodesics)"
    else part = "the rest: memory, start, benchmark"
    sum[part] += share
  }
  END { for (part in sum) printf "%5.1f %%  %s\n", sum[part], part }' | sort -rn
