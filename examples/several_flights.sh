#!/usr/bin/env bash
# Four flights of one aircraft whose lift slope and elevator differ by a few percent from flight to flight, in four winds,
# identified together: several_flights.sh VERIDYN OUT
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
veridyn=$1
out=$2
mkdir -p "$out"
changes=("CL_alpha = 3.43, Cm_de = 1.05" "CL_alpha = 3.75, Cm_de = 0.96" "CL_alpha = 3.55, Cm_de = 1.02" "CL_alpha = 3.68, Cm_de = 0.98")
winds=("[4, -2, 0]" "[-3, 1, 0]" "[0, 5, 0]" "[1, 1, 0]")
for flight in 1 2 3 4; do
  i=$((flight - 1))
  "$veridyn" simulate "$here/studies/simulated_flight.toml" --quiet --seed "$flight" --out "$out/simulated$flight" \
    --set flight.duration=150 --set "flight.turbulence=low_light" --set "flight.wind=${winds[$i]}" \
    --set "flight.change=[{ time = 0.01, parameters = { ${changes[$i]} } }]"
  cp "$out/simulated$flight/recording.csv" "$out/flight$flight.csv"
done
cp "$here/studies/several_flights.toml" "$out"
"$veridyn" identify "$out/several_flights.toml" --quiet --out "$out/identified"
"$veridyn" validate "$out/several_flights.toml" --quiet --estimate-file "$out/identified/estimate.json" --out "$out/tried"
# Every recording is named by the results.
for file in identified/estimate.json identified/run.json tried/estimate.json; do
  for flight in 1 2 3 4; do
    grep -q "flight$flight.csv" "$out/$file" || { echo "$file does not name flight$flight.csv" >&2; exit 1; }
  done
done
