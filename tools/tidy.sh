#!/usr/bin/env bash
# clang-tidy over the project as it is compiled, sources of a folder together: tidy.sh BUILD_DIR JOBS FOLDER... The checks
# are in .clang-tidy; folders that read files by strangers have the static analyzer as well.
set -euo pipefail
build=$1
jobs=$2
shift 2
export analyzer='clang-analyzer-core.*,clang-analyzer-cplusplus.*,clang-analyzer-deadcode.*'
# clang knows neither the precompiled headers of g++ nor its limits of inlining: their flags are taken out of a copy of the
# compile commands. Its -Wconversion includes signs, that of g++ does not.
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
export copy
sed -E 's/-Winvalid-pch//; s/-include [^ "]*cmake_pch\.hxx//; s/-finline-limit=[0-9]+//; s/--param=[a-z-]+=[0-9]+//g; s/-Wconversion/-Wconversion -Wno-sign-conversion/' "$build/compile_commands.json" >"$copy/compile_commands.json"

tidy() { # SOURCE
  local checks=-bugprone-suspicious-include # sources compiled together include each other
  case $1 in */veridyn/core/* | */veridyn/io/*) checks+=,$analyzer ;; esac
  clang-tidy -p "$copy" --quiet --warnings-as-errors='*' --checks="$checks" "$1"
}
export -f tidy

for folder in "$@"; do
  found=$(sed -nE "s|^ *\"file\": \"($PWD/($build/)?$folder/.*\.c(pp\|xx))\".*|\1|p" "$build/compile_commands.json" | grep -v cmake_pch || true)
  [ -n "$found" ] || { echo "tidy: no source is compiled in '$folder'" >&2; exit 2; }
  echo "$found"
done | sort -u | xargs -r -P "$jobs" -n 1 bash -c 'tidy "$0"'
