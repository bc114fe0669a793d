#!/bin/bash
# A Debian 11 in a folder, for Gazebo 11: newer Debians do not have it.
# usage: gazebo-chroot.sh create FOLDER                create it, if it is missing; MIRROR: another than debootstrap's
#        gazebo-chroot.sh run FOLDER COMMAND...        run a command in it, in the current folder and as the current user
# Inside, /tmp, the project, the current folder and the folder of ROS are those outside; so are the network and the
# variables of ROS and Gazebo. Mounts are private to the command: they vanish with it.
set -euo pipefail
project=$(cd "$(dirname "$0")/.." && pwd)
action=${1:?create or run} chroot=$(realpath -m "${2:?folder of the chroot}")
shift 2
ros_home=${ROS_HOME:-$HOME/.ros}

packages=(catkin cmake g++ gazebo libeigen3-dev libgazebo-dev libgeometry-msgs-dev libnav-msgs-dev libroscpp-dev
  libros-rosgraph-msgs-dev libsensor-msgs-dev libstd-msgs-dev libtf2-msgs-dev make python3-geometry-msgs
  python3-nav-msgs python3-roslaunch python3-rosservice python3-rostopic python3-sensor-msgs python3-setuptools
  python3-std-msgs python3-tf2-msgs ros-geometry-msgs ros-message-generation ros-message-runtime ros-std-msgs)

as_root=()
if [ "$(id -u)" != 0 ]; then
  command -v sudo > /dev/null || { echo "a chroot needs root: run this as root, or install sudo"; exit 1; }
  as_root=(sudo)
fi

inside() { # CHROOT USER COMMAND...
  local variables=() line
  while IFS= read -r line; do variables+=("$line"); done < <(
    env | grep -E '^(ROS_(MASTER_URI|HOSTNAME|IP|NAMESPACE|HOME|LOG_DIR)|GAZEBO_[A-Z_]+|DISPLAY|XAUTHORITY|HOME|TERM)=')
  mkdir -p "$ros_home"
  "${as_root[@]}" unshare --mount --propagation private bash -c '
    set -e
    chroot=$1 user=$2 project=$3 folder=$4 ros_home=$5 home=$6
    shift 6
    install -d -o "${user%:*}" -g "${user#*:}" "$chroot$home"
    mount --bind /proc "$chroot/proc"
    mount --rbind /dev "$chroot/dev"
    for shared in /tmp "$project" "$folder" "$ros_home"; do
      mkdir -p "$chroot$shared"
      mountpoint -q "$chroot$shared" || mount --bind "$shared" "$chroot$shared"
    done
    exec chroot --userspec="$user" "$chroot" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 \
      FOLDER="$folder" "$@"
  ' bash "$1" "$2" "$project" "$PWD" "$ros_home" "$HOME" "${variables[@]}" bash -c 'cd "$FOLDER" && exec "$@"' bash "${@:3}"
}

create() {
  if [ -e "$chroot/.has-gazebo" ]; then return; fi
  echo "-- creating a Debian 11 with Gazebo 11 in $chroot: about 10 minutes, 2.1 GB; this happens once"
  "$project/setup/install-debian-packages.sh" debootstrap debian-archive-keyring
  if [ -n "$(ls -A "$chroot" 2> /dev/null)" ] && [ ! -e "$chroot/.to-have-gazebo" ]; then
    echo "$chroot: has other files; expected a new folder"
    exit 1
  fi
  # An interrupted attempt starts again.
  "${as_root[@]}" rm -rf --one-file-system "$chroot"
  "${as_root[@]}" mkdir -p "$chroot"
  "${as_root[@]}" touch "$chroot/.to-have-gazebo"
  "${as_root[@]}" debootstrap --variant=minbase --include=ca-certificates bullseye "$chroot" \
    ${MIRROR:+"$MIRROR"}
  # What this machine needs to reach its mirror, and names of the loopback for ROS.
  apt-config dump Acquire | "${as_root[@]}" tee "$chroot/etc/apt/apt.conf.d/99acquire" > /dev/null
  "${as_root[@]}" cp -L /etc/hosts /etc/resolv.conf "$chroot/etc/"
  if [ -d /etc/apt/auth.conf.d ]; then "${as_root[@]}" cp -a /etc/apt/auth.conf.d "$chroot/etc/apt/"; fi
  printf '#!/bin/sh\nexit 101\n' | "${as_root[@]}" tee "$chroot/usr/sbin/policy-rc.d" > /dev/null  # no services
  "${as_root[@]}" chmod 755 "$chroot/usr/sbin/policy-rc.d"
  inside "$chroot" 0:0 apt-get update -q
  inside "$chroot" 0:0 env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${packages[@]}"
  inside "$chroot" 0:0 apt-get clean
  "${as_root[@]}" touch "$chroot/.has-gazebo"
}

case $action in
  create) create ;;
  run)
    [ -e "$chroot/.has-gazebo" ] || { echo "$chroot has no Gazebo; create it with: make gazebo"; exit 1; }
    inside "$chroot" "$(id -u):$(id -g)" "$@"
    ;;
  *) echo "$action: expected create or run"; exit 1 ;;
esac
