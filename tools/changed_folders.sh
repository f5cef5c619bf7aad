#!/usr/bin/env bash
# The folders below veridyn, bench/reproduction and apps whose C++ changed since this branch left BASE (origin/main): what
# clang-tidy has to look at again. Where the branch is BASE itself, as on a clone of what has just landed, since the last commit
# three hours before the newest. A changed header counts as its folder; `make nightly` looks at everything.
set -euo pipefail
cd "$(dirname "$0")/.."
base=$(git merge-base HEAD "${BASE:-origin/main}" 2>/dev/null || true)
if [ -z "$base" ] || [ "$base" = "$(git rev-parse HEAD)" ]; then
  newest=$(git log -1 --format=%ct)
  base=$(git rev-list -1 --before=$((newest - 10800)) HEAD)
fi
[ -n "$base" ] || base=$(git rev-list --max-parents=0 HEAD | tail -n 1)
git diff --name-only --no-renames --diff-filter=d "$base" -- 'veridyn/*.[ch]pp' 'bench/reproduction/*.[ch]pp' 'apps/*.[ch]pp' | xargs -r -n 1 dirname | sort -u |
  while read -r folder; do
    # A folder of headers alone is looked at where it is compiled: with its module. Headers above all modules have none.
    while [ "$folder" != . ] && ! compgen -G "$folder/*.cpp" >/dev/null; do folder=$(dirname "$folder"); done
    [ "$folder" = . ] || echo "$folder"
  done | sort -u
