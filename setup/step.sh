#!/bin/bash
# Runs one step of the set-up: its output goes to a log; its progress is shown, and after a failure the end of the log.
# usage: step.sh TITLE LOG COMMAND...
set -u
title=$1 log=$2
shift 2
mkdir -p "$(dirname "$log")"

progress() { # percent of the packages or files that the log contains, if it shows how many there are
  awk '/newly installed/ { for (i = 2; i <= NF; ++i) if ($i == "newly") all = 3 * $(i - 1) }
       all && /^(Get:|Unpacking |Setting up )/ { percent = 100 * ++done / all }
       /^\[ *[0-9]+%\]/ { split($0, part, /[[%]/); percent = part[2] }
       /^ *\[[0-9]+\/[0-9]+\] / { split($1, part, /[^0-9]/); percent = 100 * part[2] / part[3] }  # ninja, for a wheel
       END { if (percent != "") printf("%d %%, ", (percent > 100) ? 100 : percent) }' "$log" 2> /dev/null
}

echo "-- $title"
start=$SECONDS
"$@" > "$log" 2>&1 < /dev/null &
command=$!
trap 'kill "$command" 2> /dev/null' INT TERM
next=10
while kill -0 "$command" 2> /dev/null; do
  sleep 0.2
  if ((SECONDS - start >= next)); then
    echo "--   $title: $(progress)$((SECONDS - start)) s"
    next=$((next + 10))
  fi
done
if wait "$command"; then
  echo "-- $title: done after $((SECONDS - start)) s"
else
  status=$?
  tail -n 25 "$log" >&2
  echo "-- $title: failed; the whole log is $log" >&2
  exit "$status"
fi
