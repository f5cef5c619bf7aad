#!/usr/bin/env bash
# Installs the Debian packages that the build needs and that are missing. Quiet and quick when nothing is.
set -euo pipefail

packages=(
  g++ cmake ninja-build ccache pkg-config git
  libeigen3-dev libboost-dev libceres-dev libtbb-dev libmatio-dev zlib1g-dev libzip-dev liblz4-dev libzstd-dev libsqlite3-dev libtomlplusplus-dev nlohmann-json3-dev
  libcli11-dev libfmt-dev libpugixml-dev libmuparser-dev libgtest-dev libgmock-dev libbenchmark-dev libsimbody-dev coinor-libipopt-dev
  libasio-dev libevdev-dev libcpp-httplib-dev libopencv-core-dev libopencv-imgproc-dev libopencv-videoio-dev
  clang-14 clang-format-14 clang-format clang-tidy-14 clang-tidy libclang-rt-14-dev
  chromium doxygen libopenmpi-dev openmpi-bin iproute2 python3-venv python3-jsonschema
)
# The report's plots need Node 18 or later, wherever it comes from; Debian's will do.
if ! command -v node >/dev/null || ! command -v npm >/dev/null; then packages+=(nodejs npm); fi

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then exit 0; fi

sudo=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "setup: missing packages, and neither root nor sudo: ${missing[*]}" >&2; exit 1; }
  sudo=(sudo)
fi
echo "setup: installing ${missing[*]}"
"${sudo[@]}" apt-get update -qq
DEBIAN_FRONTEND=noninteractive "${sudo[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
