#!/bin/bash
# rosbags 0.11.9: of the messages that robots send, one has another form in ROS 2 Humble than in later distributions.
#
# A sensor_msgs/Range, as of a sonar, ends with a float32 "variance" since ROS 2 Iron. Types are found by their names, so
# a .db3 file of Humble, which has no definitions, is read with those of the reader: with those of Jazzy the scan, the
# odometry and the camera are read, and the sonar is not, nor the other way round. Seen with Python 3.11:
#
#   types of *_msgs in both whose attributes differ: sensor_msgs/msg/Range
#   written as in ROS2_HUMBLE, read as in ROS2_JAZZY: SerdeError
#   written as in ROS2_JAZZY, read as in ROS2_HUMBLE: SerdeError
#
# This script fails if that changes.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet rosbags==0.11.9
"$folder/venv/bin/python" - <<'PYTHON'
from rosbags.typesys import Stores, get_typestore

stores = {store.name: get_typestore(store) for store in (Stores.ROS2_HUMBLE, Stores.ROS2_JAZZY)}
humble, jazzy = (store.fielddefs for store in stores.values())
common = [name for name in humble.keys() & jazzy.keys() if name.split("/")[0].endswith("_msgs")]
differ = sorted(name for name in common if humble[name][1] != jazzy[name][1])
print("types of *_msgs in both whose attributes differ:", *differ)
assert differ == ["sensor_msgs/msg/Range"], "this finding is out of date"


def sonar(store):
    types = store.types
    stamp = types["builtin_interfaces/msg/Time"](sec=1, nanosec=0)
    header = types["std_msgs/msg/Header"](stamp=stamp, frame_id="sonar")
    values = {"radiation_type": 0, "field_of_view": 0.5, "min_range": 0.0, "max_range": 3.0, "range": 1.5}
    added = {"variance": 0.0} if len(store.fielddefs["sensor_msgs/msg/Range"][1]) > 6 else {}
    return types["sensor_msgs/msg/Range"](header=header, **values, **added)


for written, read in (tuple(stores), tuple(stores)[::-1]):
    data = stores[written].serialize_cdr(sonar(stores[written]), "sensor_msgs/msg/Range")
    assert stores[written].deserialize_cdr(data, "sensor_msgs/msg/Range").range == 1.5
    try:
        stores[read].deserialize_cdr(data, "sensor_msgs/msg/Range")
    except Exception as error:
        print(f"written as in {written}, read as in {read}: {type(error).__name__}")
    else:
        raise SystemExit("it is read; this finding is out of date")
PYTHON
