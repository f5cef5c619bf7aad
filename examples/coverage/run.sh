#!/usr/bin/env bash
# Do 95 % intervals hold the truth 95 % of the time? Simulated flights of coverage.toml, one a seed, identified from what the
# sensors recorded; every parameter compared with the aircraft's own.
#   run.sh VERIDYN OUT SEEDS [--set key=value ...]
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
veridyn=$1
out=$2
seeds=$3
shift 3
mkdir -p "$out"
"$veridyn" simulate "$here/coverage.toml" --quiet --set flight.duration=2 --set flight.plan=none --out "$out/truth"
for method in GTLS OLS; do
  for seed in $(seq 1 "$seeds"); do
    "$veridyn" identify "$here/coverage.toml" --quiet --seed "$seed" --set "identify.method=$method" --out "$out/$method/$seed" "$@"
  done
done
node "$here/coverage.mjs" "$out"
