#!/usr/bin/env bash
# clang-tidy over the project's own translation units: tidy.sh BUILD_DIR JOBS. The checks are in .clang-tidy.
set -euo pipefail
build=$1
jobs=$2
git ls-files 'veridyn/*.cpp' 'apps/*.cpp' | xargs -P "$jobs" -n 4 clang-tidy -p "$build" --quiet --warnings-as-errors='*'
