#!/bin/bash
# Installs the C++ libraries that wheels need into a folder, from their released sources: package managers of macOS and
# Windows have Box2D 3, which has another interface. usage: wheel-libraries.sh PREFIX
set -eu
prefix=$1
sources=$(mktemp -d)
trap 'rm -rf "$sources"' EXIT

install() { # URL TAG OPTION...
  local folder
  folder=$sources/$(basename "$1")
  git clone --quiet --depth 1 --branch "$2" "$1" "$folder"
  cmake -S "$folder" -B "$folder/build" -DCMAKE_INSTALL_PREFIX="$prefix" -DCMAKE_PREFIX_PATH="$prefix" \
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DCMAKE_POLICY_VERSION_MINIMUM=3.5 "${@:3}"
  cmake --build "$folder/build" --config Release --parallel
  cmake --install "$folder/build" --config Release
}

install https://gitlab.com/libeigen/eigen 3.4.0 -DBUILD_TESTING=OFF -DEIGEN_BUILD_DOC=OFF
install https://github.com/yixuan/spectra v1.0.1
install https://github.com/erincatto/box2d v2.4.1 -DBOX2D_BUILD_UNIT_TESTS=OFF -DBOX2D_BUILD_TESTBED=OFF
