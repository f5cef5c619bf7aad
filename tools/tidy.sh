#!/usr/bin/env bash
# clang-tidy over the project as it is compiled, sources of a folder together: tidy.sh BUILD_DIR JOBS FOLDER... takes every unit
# that holds a source of these folders. The checks are in .clang-tidy; folders that read files by strangers have the static
# analyzer as well.
set -euo pipefail
build=$1
jobs=$2
shift 2
export build analyzer='clang-analyzer-core.*,clang-analyzer-cplusplus.*,clang-analyzer-deadcode.*'
# The precompiled headers are those of the same clang.
sed -nE 's|^ *"command": .* -o ([^ ]*cmake_pch\.hxx\.pch) .*|\1|p' "$build/compile_commands.json" | xargs -r ninja -C "$build" -j "$jobs" >/dev/null

tidy() { # UNIT
  local checks=-bugprone-suspicious-include # sources compiled together include each other
  case $1 in */veridyn/core/* | */veridyn/io/*) checks+=,$analyzer ;; esac
  clang-tidy -p "$build" --quiet --warnings-as-errors='*' --checks="$checks" "$1"
}
export -f tidy

units=$(sed -nE 's|^ *"file": "(.*\.c(pp\|xx))".*|\1|p' "$build/compile_commands.json" | grep -v -e cmake_pch -e _headers.cpp)
for folder in "$@"; do
  found=""
  for unit in $units; do
    case $unit in
      "$PWD/$folder"/*) found+=$unit$'\n' ;;
      */Unity/unity_*) if grep -q "\"$PWD/$folder/" "$unit"; then found+=$unit$'\n'; fi ;;
    esac
  done
  [ -n "$found" ] || { echo "tidy: no source is compiled in '$folder'" >&2; exit 2; }
  printf '%s' "$found"
done | sort -u | xargs -r -P "$jobs" -n 1 bash -c 'tidy "$0"'
