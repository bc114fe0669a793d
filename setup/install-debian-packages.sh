#!/bin/sh
# Installs the missing packages of a list and prints their names.
# usage: install-debian-packages.sh LIST
set -eu
missing=$(sed 's/#.*//' "$1" | while read -r package; do
  [ -z "$package" ] && continue
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || echo "$package"
done)
if [ -z "$missing" ]; then
  echo "-- Debian packages: all installed"
  exit 0
fi
echo "-- Debian packages: installing" $missing
root=
if [ "$(id -u)" != 0 ]; then
  command -v sudo >/dev/null || { echo "sudo is not installed; as root, run 'apt-get install" $missing"'" >&2; exit 1; }
  root="sudo"
fi
export DEBIAN_FRONTEND=noninteractive
$root apt-get update -q
$root apt-get install -q -y --no-install-recommends $missing
