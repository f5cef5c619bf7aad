#!/usr/bin/env bash
# Recursive estimation beside the decompositions it replaces, by Eigen and by GNU Octave (apt: octave):
# recursive_svd.sh BENCH_BUILD_DIR
set -euo pipefail
"$1"/bin/veridyn_estimation_bench --benchmark_filter='six_coefficients|one_coefficient|eigen_svd'
if command -v octave >/dev/null; then
  octave --no-gui --norc -q "$(dirname "$0")/recursive_svd.m" 2>&1 | grep '^octave' || true
else
  echo "octave is not installed: its figures are left out"
fi
