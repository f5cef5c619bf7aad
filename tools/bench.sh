#!/usr/bin/env bash
# Runs every benchmark of a build folder: bench.sh BUILD_DIR. A table on the terminal, JSON beside it.
set -euo pipefail
for program in "$1"/bin/*_bench; do
  echo "== $(basename "$program")"
  "$program" --benchmark_out="$1/$(basename "$program").json" --benchmark_out_format=json
done
