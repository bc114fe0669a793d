#!/bin/bash
# Builds the plugins, and the messages that they need, on a machine with Gazebo 11 and ROS 1.
# usage: gazebo/build.sh BUILD JOBS        in the project's folder; writes BUILD/devel/lib/librobotteamsim_gazebo*.so
set -eu
build=$1 jobs=$2
export ROS_LANG_DISABLE=${ROS_LANG_DISABLE-geneus:genlisp:gennodejs:genpy}
# Once: it makes the messages again, and with them all that uses them.
if [ ! -f "$build/Makefile" ]; then
  cmake -S . -B "$build" -DROBOTTEAMSIM_ONLY_GAZEBO=ON || { status=$?; rm -f "$build/Makefile"; exit "$status"; }
fi
cmake --build "$build" -j"$jobs"
