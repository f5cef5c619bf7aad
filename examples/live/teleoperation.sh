#!/bin/sh
# examples/live/teleoperation.sh VERIDYN OUT: the full teleoperation loop, each part a process: a driver (a table), the
# rig, a scaled car at the end of a serial line, a platform, a camera above the first 20 m of the way. The run is
# replayed with the same orders and commands bit for bit; then its recording becomes a model of the car: identified, and
# tracked as it would be while it drives.
set -eu
veridyn=${1:?usage: examples/live/teleoperation.sh VERIDYN OUT}
out=${2:?usage: examples/live/teleoperation.sh VERIDYN OUT}
here=$(dirname "$0")
port=$((30000 + 5 * ($$ % 6000)))
line=${TMPDIR:-/tmp}/veridyn_car_$$
sets="--set live.platform=127.0.0.1:$port --set live.stop=127.0.0.1:$((port + 1)) --set live.car.line=$line"
sets="$sets --set live.car.truth=127.0.0.1:$((port + 2)) --set live.camera.address=127.0.0.1:$((port + 3))"
rm -rf "$out" && mkdir -p "$out"
"$veridyn" rig platform "$here/car.toml" $sets & platform=$!
"$veridyn" rig car "$here/car.toml" $sets --out "$out/car" & car=$!
# A program that was built without OpenCV has no camera; the rig runs as before.
view='{x=[-3,20],y=[-6,6],rate=10}'
"$veridyn" rig camera "$here/car.toml" $sets --set live.camera.view="$view" --out "$out/camera" & camera=$!
trap 'kill $platform $car $camera 2>/dev/null || true' EXIT
tries=0
until [ -e "$line" ] || [ $tries -gt 100 ]; do
  sleep 0.1
  tries=$((tries + 1))
done
"$veridyn" cue "$here/car.toml" --live --start --seconds 13.2 $sets --set live.fade=1 --out "$out/run" </dev/null
kill -INT $platform $car $camera 2>/dev/null || true
wait $camera || [ ! -e "$out/camera" ]
wait $platform # fails where an order was beyond the platform's limits
wait $car
"$veridyn" cue --replay "$out"/run/*.vlr --quiet --out "$out/replay"
cmp "$out/run/platform.csv" "$out/replay/platform.csv"
cmp "$out/run/drive.csv" "$out/replay/drive.csv"
# From here on with what a real car leaves.
cp "$here/identify_car.toml" "$out"
"$veridyn" identify "$out/identify_car.toml" --set data.file=run/drive.csv --out "$out/identify"
"$veridyn" track "$out/identify_car.toml" --set data.file=run/drive_live.csv --quiet --out "$out/track"
