#!/bin/sh
# examples/live/run.sh VERIDYN OUT [SECONDS]: the whole virtual rig on loopback, a process each: a car that sends telemetry, the
# rig, a platform. The run is replayed from its recording, with the same orders bit for bit.
set -eu
veridyn=${1:?usage: examples/live/run.sh VERIDYN OUT [SECONDS]}
out=${2:?usage: examples/live/run.sh VERIDYN OUT [SECONDS]}
seconds=${3:-12}
study=$(dirname "$0")/../studies/cueing/live.toml
port=$((30000 + 3 * ($$ % 10000)))
sets="--set live.telemetry=127.0.0.1:$port --set live.platform=127.0.0.1:$((port + 1)) --set live.page=127.0.0.1:$((port + 2)) --set live.signs=while"
rm -rf "$out" && mkdir -p "$out"
"$veridyn" rig platform "$study" $sets & platform=$!
"$veridyn" rig vehicle "$study" $sets --quiet & vehicle=$!
trap 'kill $platform $vehicle 2>/dev/null || true' EXIT
"$veridyn" cue "$study" --live --start --seconds "$seconds" $sets --out "$out/run" </dev/null
kill -INT $platform
wait $platform # fails where an order was beyond the platform's limits
"$veridyn" cue --replay "$out"/run/*.vlr --quiet --out "$out/replay"
cmp "$out/run/platform.csv" "$out/replay/platform.csv"
