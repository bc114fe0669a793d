#!/bin/bash
# Runs targets of make one after the other, also after a failure, and prints a table at the end. usage: nightly.sh TARGET...
set -u
table=$(printf '%-10s %-8s %7s' target result seconds)
status=0
for target; do
  echo "-- nightly: $target"
  SECONDS=0
  result=passed
  "${MAKE:-make}" --no-print-directory "$target" || { result=FAILED; status=1; }
  table+=$(printf '\n%-10s %-8s %7d' "$target" "$result" "$SECONDS")
done
echo "$table"
exit $status
