#!/bin/sh
# fuzz/run.sh SECONDS BUILD_DIR [FORMAT...]: runs every fuzz target (or those named) for so many seconds each, starting
# from its seeds. Corpora and what was found stay under BUILD_DIR/fuzz-corpus and BUILD_DIR/fuzz-findings.
set -eu
seconds=${1:?usage: fuzz/run.sh SECONDS BUILD_DIR [FORMAT...]}
build=${2:?usage: fuzz/run.sh SECONDS BUILD_DIR [FORMAT...]}
shift 2
if [ $# -eq 0 ]; then
  set -- dataflash dataflash_text ulog csv mat npy npz packet storage osim tir crg telemetry live_file teleoperation wheel
  if [ -x "$build/bin/fuzz_camera" ]; then set -- "$@" camera; fi
fi
"$build/bin/fuzz_seeds" "$build/fuzz-corpus"
mkdir -p "$build/fuzz-corpus/osim"
cp "$(dirname "$0")"/../veridyn/muscle/osim/models/*.osim "$build/fuzz-corpus/osim/"
failed=0
for format in "$@"; do
  mkdir -p "$build/fuzz-findings/$format"
  echo "== $format, $seconds s"
  if ! "$build/bin/fuzz_$format" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=4096 -max_len=65536 \
    -print_final_stats=1 -verbosity=0 -artifact_prefix="$build/fuzz-findings/$format/" "$build/fuzz-corpus/$format"; then
    echo "FOUND: see $build/fuzz-findings/$format" >&2
    failed=1
  fi
done
exit $failed
