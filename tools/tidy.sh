#!/usr/bin/env bash
# clang-tidy over translation units of the project: tidy.sh BUILD_DIR JOBS FOLDER... The checks are in .clang-tidy.
set -euo pipefail
build=$1
jobs=$2
shift 2
# clang does not read the precompiled headers of g++: their flags are taken out of a copy of the compile commands.
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
sed -E 's/-Winvalid-pch//; s/-include [^ "]*cmake_pch\.hxx//' "$build/compile_commands.json" >"$copy/compile_commands.json"
for folder in "$@"; do git ls-files "$folder/*.cpp"; done |
  xargs -P "$jobs" -n 2 clang-tidy -p "$copy" --quiet --warnings-as-errors='*'
