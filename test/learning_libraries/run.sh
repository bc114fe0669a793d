#!/bin/bash
# Trains with a learning library's own loop: test/learning_libraries/run.sh skrl [NUMBER of the line "# needs:", 1]
# In a new virtual environment in /tmp, with the wheel in dist and the pinned versions that the script names, for each
# team of teams.py. Not part of `make test`: torch has 0.75 GB (its index for CPUs, as in docs/learning.md) or some GB.
set -e
here=$(cd "$(dirname "$0")" && pwd)
script=$here/with_$1.py
mapfile -t needs < <(sed -n 's/^# needs: //p' "$script")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
# shellcheck disable=SC2086
"$folder/venv/bin/pip" install --quiet ${needs[$((${2:-1} - 1))]} "$(ls "$here"/../../dist/*.whl)[learning]"
cd "$folder" && PYTHONPATH=$here:$here/../../examples/learning OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 venv/bin/python "$script"
