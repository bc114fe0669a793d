"""Message classes for bags that are written and read without ROS."""

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from robotteamsim.errors import RecordingError
from robotteamsim.scenario.shipped import share_roots

_TF_MESSAGE = "geometry_msgs/TransformStamped[] transforms\n"  # rosbags does not include tf2_msgs of ROS 1


class BagTypes:
    """Builds messages of rosbags' classes; the `make` of `recording.topics`."""

    def __init__(self, typestore: Typestore | None = None) -> None:
        self.typestore = bag_typestore() if typestore is None else typestore
        self.serialized = self.typestore.serialize_ros1
        self._classes = {name.replace("/msg/", "/"): cls for name, cls in self.typestore.types.items()}
        self._time = self._classes["builtin_interfaces/Time"]
        self._duration = self._classes["builtin_interfaces/Duration"]

    def __call__(self, type_name: str, /, **attributes: Any) -> Any:
        """Return a message of a type such as "nav_msgs/Odometry"."""
        return self._classes[type_name](**attributes)

    def time(self, time_ns: int) -> Any:
        """Return the stamp of a time [ns]."""
        return self._time(*divmod(time_ns, 10**9))

    def duration(self, duration_ns: int) -> Any:
        """Return a duration [ns]."""
        return self._duration(*divmod(duration_ns, 10**9))


class Ros2Types(BagTypes):
    """Builds messages of ROS 2, for MCAP files and nodes."""

    def __init__(self) -> None:
        super().__init__(bag_typestore(Stores.ROS2_HUMBLE))
        self.serialized = self.typestore.serialize_cdr

    def __call__(self, type_name: str, /, **attributes: Any) -> Any:
        """Return a message; headers of ROS 2 have no `seq`, and names no capitals."""
        if type_name == "std_msgs/Header":
            del attributes["seq"]
        if type_name == "sensor_msgs/CameraInfo":  # ROS 1 writes its matrices with capitals
            attributes = {name.lower(): value for name, value in attributes.items()}
        if type_name == "visualization_msgs/Marker":  # in ROS 2 it may have a texture, and the file of its mesh
            no_data = np.zeros(0, np.uint8)
            texture = self("sensor_msgs/CompressedImage", header=attributes["header"], format="", data=no_data)
            mesh = self("visualization_msgs/MeshFile", filename="", data=no_data)
            attributes |= {"texture_resource": "", "texture": texture, "uv_coordinates": [], "mesh_file": mesh}
        return super().__call__(type_name, **attributes)


@cache
def bag_typestore(ros: Stores = Stores.ROS1_NOETIC) -> Typestore:
    """Return the types of a version of ROS and of this package, for reading and writing bags; add none to them.

    Raises: RecordingError: the message definitions of the package are not installed.
    """
    typestore = get_typestore(ros)
    types = {}
    if "tf2_msgs/msg/TFMessage" not in typestore.types:
        types = get_types_from_msg(_TF_MESSAGE, "tf2_msgs/msg/TFMessage")
    for path in _message_files():
        types.update(get_types_from_msg(path.read_text(encoding="utf-8"), f"robotteamsim/msg/{path.stem}"))
    typestore.register(types)
    return typestore


@cache
def _message_files() -> tuple[Path, ...]:
    for root in share_roots():
        if files := sorted((root / "msg").glob("*.msg")):
            return tuple(files)
    places = ", ".join(str(root / "msg") for root in share_roots())
    raise RecordingError(f"{places}: no message definitions found; is robotteamsim installed completely?")
