#!/bin/bash
# rosbags 0.11.9: a topic whose quality of service differs between metadata.yaml and the storage file is lost silently.
#
# rosbags.rosbag2.Reader takes the quality of service of a connection as a part of its identity. If metadata.yaml was
# edited, as for `ros2 bag play` with another history depth, its connections are none of those in the file: they are listed,
# with their number of messages, but messages() yields none of them, and raises nothing. Seen on Debian 12, Python 3.11:
#
#   as written: 3 listed, 3 read
#   with another depth in metadata.yaml: 3 listed, 0 read
#
# This script fails if that changes.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet rosbags==0.11.9
cd "$folder" && venv/bin/python - <<'PYTHON'
from pathlib import Path

from rosbags.rosbag2 import Reader, StoragePlugin, Writer
from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.typesys import Stores, get_typestore

never = QosTime(2147483647, 4294967295)
qos = Qos(
    QosHistory.KEEP_LAST, 10, QosReliability.RELIABLE, QosDurability.VOLATILE, never, never,
    QosLiveliness.AUTOMATIC, never, False,
)
store = get_typestore(Stores.ROS2_JAZZY)
String = store.types["std_msgs/msg/String"]
bag = Path("bag")
with Writer(bag, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
    chatter = writer.add_connection("/chatter", String.__msgtype__, typestore=store, offered_qos_profiles=[qos])
    for stamp in range(3):
        writer.write(chatter, stamp, store.serialize_cdr(String(data="hello"), String.__msgtype__))


def counts():
    with Reader(bag) as reader:
        return reader.message_count, sum(1 for _ in reader.messages())


listed, read = counts()
print(f"as written: {listed} listed, {read} read")
assert (listed, read) == (3, 3)
metadata = bag / "metadata.yaml"
text = metadata.read_text()
assert "depth: 10" in text
metadata.write_text(text.replace("depth: 10", "depth: 5"))
listed, read = counts()
print(f"with another depth in metadata.yaml: {listed} listed, {read} read")
assert (listed, read) == (3, 0), "this finding is out of date"
PYTHON
