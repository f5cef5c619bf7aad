#!/usr/bin/env bash
# tools/peers.sh COMMAND ...: runs a command of the virtual environment build/peers/venv, which holds what
# bench/peers/requirements.txt lists and is rebuilt when that changes. Where no package index can be reached and there
# is no environment yet, one line says so and nothing is run, which is no failure.
set -euo pipefail
cd "$(dirname "$0")/.."
folder=build/peers
requirements=bench/peers/requirements.txt

install() {
  local python="" candidate
  for candidate in python3 /usr/bin/python3 python3.13 python3.12 python3.11; do
    if "$candidate" -c 'import sys, venv, ensurepip; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))' 2>/dev/null; then
      python=$candidate
      break
    fi
  done
  [ -n "$python" ] || { echo "peers: needs Python 3.11 to 3.13 with its module venv (Debian's python3-venv)" >&2; exit 1; }
  rm -rf "$folder/venv" "$folder/installed.txt"
  mkdir -p "$folder"
  "$python" -m venv "$folder/venv"
  local pip=("$folder/venv/bin/pip" --quiet --disable-pip-version-check)
  # One small package tells a machine without an index from a package that is not to be had.
  if ! "${pip[@]}" download --no-cache-dir --no-deps --timeout 10 --retries 1 --dest "$folder/probe" \
      "$(grep '^iniconfig==' "$requirements")" >/dev/null 2>&1; then
    echo "peers: skipped, no package index can be reached"
    exit 0
  fi
  echo "peers: installing $(grep -c '==' "$requirements") packages into $folder/venv"
  "${pip[@]}" install --no-deps --requirement "$requirements"
  cp "$requirements" "$folder/installed.txt"
}

cmp -s "$requirements" "$folder/installed.txt" || install
export PYTHONPYCACHEPREFIX="$PWD/$folder/pycache"
command=$1
shift
exec "$folder/venv/bin/$command" "$@"
