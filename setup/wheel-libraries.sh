#!/bin/bash
# Installs the C++ libraries that wheels need into a folder, from their released sources: package managers of macOS and
# Windows have Box2D 3, which has another interface. usage: wheel-libraries.sh PREFIX
set -eu
prefix=$1
sources=$(mktemp -d)
trap 'rm -rf "$sources"' EXIT

install() { # URL COMMIT OPTION...; a tag can be moved, a commit cannot
  local folder
  folder=$sources/$(basename "$1")
  git init --quiet "$folder"
  git -C "$folder" fetch --quiet --depth 1 "$1" "$2"
  git -C "$folder" checkout --quiet FETCH_HEAD
  cmake -S "$folder" -B "$folder/build" -DCMAKE_INSTALL_PREFIX="$prefix" -DCMAKE_PREFIX_PATH="$prefix" \
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DCMAKE_POLICY_VERSION_MINIMUM=3.5 "${@:3}"
  cmake --build "$folder/build" --config Release --parallel
  cmake --install "$folder/build" --config Release
}

# Eigen 3.4.0, Spectra 1.0.1 and Box2D 2.4.1
install https://gitlab.com/libeigen/eigen 3147391d946bb4b6c68edd901f2add6ac1f31f8c -DBUILD_TESTING=OFF -DEIGEN_BUILD_DOC=OFF
install https://github.com/yixuan/spectra bdd707b9a872bb17622696ed3cca2a27b743a5b7
install https://github.com/erincatto/box2d 9ebbbcd960ad424e03e5de6e66a40764c16f51bc \
  -DBOX2D_BUILD_UNIT_TESTS=OFF -DBOX2D_BUILD_TESTBED=OFF
