#!/bin/sh
# Installs the packages of debian-packages.txt that are missing for some purposes.
# usage: install-debian-packages.sh PURPOSE...     build, run, view, test; or names of packages
set -eu
list=$(dirname "$0")/debian-packages.txt
release=$(. /etc/os-release && echo "${VERSION_CODENAME-}")
wanted=$(for purpose; do
  if grep -qx "\[$purpose\]" "$list"; then
    awk -v all="[$purpose]" -v this="[$purpose $release]" \
      '/^\[/ { wanted = $0 == all || $0 == this; next } wanted && NF' "$list"
  else
    echo "$purpose"
  fi
done)
missing=$(for package in $wanted; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || echo "$package"
done)
if [ -z "$missing" ]; then
  echo "all installed"
  exit 0
fi
root=
if [ "$(id -u)" != 0 ]; then
  command -v sudo >/dev/null || { echo "sudo is not installed; as root, run 'apt-get install" $missing"'"; exit 1; }
  root="sudo"
fi
# Lists younger than an hour are used as they are.
if [ -z "$(find /var/lib/apt/lists -name '*Packages*' -mmin -60 2>/dev/null | head -n 1)" ]; then
  $root apt-get update -q
fi
$root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $missing
