#!/bin/sh
# fuzz/run.sh SECONDS BUILD_DIR [FORMAT...]: runs every fuzz target (or those named) for so many seconds each, JOBS (1) at a
# time, starting from its seeds. Corpora and what was found stay under BUILD_DIR/fuzz-corpus and BUILD_DIR/fuzz-findings.
set -eu
seconds=${1:?usage: fuzz/run.sh SECONDS BUILD_DIR [FORMAT...]}
build=${2:?usage: fuzz/run.sh SECONDS BUILD_DIR [FORMAT...]}
shift 2
if [ $# -eq 0 ]; then
  # shellcheck disable=SC2046
  set -- $(cat "$build/fuzz-formats.txt")
fi
"$build/bin/fuzz_seeds" "$build/fuzz-corpus"
mkdir -p "$build/fuzz-corpus/osim"
cp "$(dirname "$0")"/../veridyn/muscle/osim/models/*.osim "$(dirname "$0")"/../examples/studies/muscle/*.osim \
  "$build/fuzz-corpus/osim/"
# What a target says is printed when it ends, so that those that run alongside each other can be read.
# shellcheck disable=SC2016
printf '%s\n' "$@" | xargs -P "${JOBS:-1}" -n 1 sh -c '
  seconds=$0 build=$1 format=$2
  findings=$build/fuzz-findings/$format
  mkdir -p "$findings"
  found=0
  "$build/bin/fuzz_$format" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=4096 -max_len=65536 \
    -print_final_stats=1 -verbosity=0 -artifact_prefix="$findings/" "$build/fuzz-corpus/$format" >"$findings.log" 2>&1 || found=1
  { echo "== $format, $seconds s"; cat "$findings.log"; }
  [ $found -eq 0 ] || { echo "FOUND: see $findings" >&2; exit 1; }
' "$seconds" "$build"
