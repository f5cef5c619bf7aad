#!/bin/sh
# examples/live/dashboard.sh VERIDYN OUT: the dashboard of a folder: a live run of the virtual rig is followed by its recording
# and stopped from the dashboard; the progress of an identification is shown while it computes.
set -eu
veridyn=${1:?usage: examples/live/dashboard.sh VERIDYN OUT}
out=${2:?usage: examples/live/dashboard.sh VERIDYN OUT}
studies=$(dirname "$0")/../studies
port=$((20000 + 4 * ($$ % 2500)))
page=127.0.0.1:$((port + 2))
sets="--set live.telemetry=127.0.0.1:$port --set live.platform=127.0.0.1:$((port + 1)) --set live.page=127.0.0.1:$((port + 3))
 --set live.signs=while --set live.fade=1"
rm -rf "$out" && mkdir -p "$out"
umask 077
echo "a-token-of-this-example" >"$out/token"
"$veridyn" serve "$out" --page "$page" --token-file "$out/token" --quiet & serve=$!
"$veridyn" rig platform "$studies/cueing/live.toml" $sets --quiet & platform=$!
"$veridyn" rig vehicle "$studies/cueing/live.toml" $sets --quiet & vehicle=$!
"$veridyn" cue "$studies/cueing/live.toml" --live --start $sets --seconds 300 --quiet --out "$out/run" </dev/null & rig=$!
trap 'kill $serve $platform $vehicle $rig 2>/dev/null || true' EXIT
# shows TEXT: waits until the dashboard says this.
shows() {
  tries=0
  until curl --silent "http://$page/status" | grep -q "$1"; do
    tries=$((tries + 1))
    [ $tries -lt 300 ] || { echo "the dashboard does not say $1"; exit 1; }
    sleep 0.1
  done
  echo "the dashboard says $1"
}
ask() { curl --silent --output /dev/null --write-out '%{http_code}' --data '{"request": "emergency"}' "$@" "http://$page/control"; }
shows '"state":"running"'
[ "$(ask)" = 401 ]
[ "$(ask --header 'Authorization: Bearer not-the-token-at-all')" = 403 ]
shows '"refused":2'
[ "$(ask --header "Authorization: Bearer $(cat "$out/token")")" = 204 ]
shows '"state":"stopped"'
# On one thread it lasts a moment, on any machine.
"$veridyn" identify "$studies/muscle/posterior_arm.toml" --set identify.posterior.steps=20 --threads 1 --quiet --out "$out/identify" & identify=$!
shows '"state":"goes on"'
wait $identify
shows '"state":"done"'
# Whenever the rest is done: how long that takes is the machine's.
kill -INT $rig
wait $rig
