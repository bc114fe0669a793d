#!/bin/bash
# Configures a build folder if that is needed, and builds.
# usage: compile.sh BUILD PYTHON JOBS yes|no      yes: with the targets of the tests
set -eu
build=$1 python=$2 jobs=$3 tests=$4
export ROS_LANG_DISABLE=${ROS_LANG_DISABLE-geneus:genlisp:gennodejs}  # the package uses C++ and Python only
unset MAKEFLAGS MFLAGS  # of the make that runs this step beside others
if [ ! -f "$build/Makefile" ]; then
  cmake -S . -B "$build" -DPYTHON_EXECUTABLE="$PWD/$python" -DCATKIN_ENABLE_TESTING=OFF ||
    { status=$?; rm -f "$build/Makefile"; exit "$status"; }
fi
if [ "$tests" = yes ] && ! grep -q '^CATKIN_ENABLE_TESTING:[A-Z]*=ON' "$build/CMakeCache.txt"; then
  cmake -S . -B "$build" -DCATKIN_ENABLE_TESTING=ON
fi
cmake --build "$build" -j"$jobs"
echo "$PWD/$build/devel/lib/python3/dist-packages" > "$("$python" -c 'import site; print(site.getsitepackages()[0])')/robotteamsim.pth"
ln -sf "$PWD/$build/devel/bin/robotteamsim" "$(dirname "$python")/robotteamsim"
