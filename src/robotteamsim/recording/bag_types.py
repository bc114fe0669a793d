"""The types of messages of each version of ROS, and their bytes, without ROS."""

from functools import cache
from pathlib import Path
from typing import Any

from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from robotteamsim._core.recording import MessageType
from robotteamsim.errors import RecordingError
from robotteamsim.scenario.sensors import KINDS
from robotteamsim.scenario.shipped import share_roots
from robotteamsim.wording import described

ROS1, ROS2 = Stores.ROS1_NOETIC, Stores.ROS2_JAZZY
"""Those of whose types messages are made. Of the types that we use, ROS 2 has changed one since Humble: a
sensor_msgs/Range ends with a variance (since Iron). Fast CDR, tried in Jazzy, refuses fewer bytes than a type has, and
reads no more of them."""

_TF_MESSAGE = "geometry_msgs/TransformStamped[] transforms\n"  # rosbags does not include tf2_msgs of ROS 1
_NOTHING = "structure_needs_at_least_one_member"
"""That of a type without attributes, which has a byte in ROS 2."""
_TIMES = ("builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration")


def message_type(type_name: str, ros: Stores = ROS1) -> MessageType:
    """Return a type such as "nav_msgs/Odometry": it makes bytes of messages (`message_parts`), and messages of bytes.

    Those that it makes have attributes: times are whole numbers [ns], numbers in a row arrays, others lists.
    Raises: RecordingError: there is no definition of the type; as `bag_typestore`.
    """
    types, name = bag_typestore(ros), type_name.replace("/", "/msg/")
    if name not in types.fielddefs:
        raise RecordingError(f"{type_name}: no definition found; a sensor's own types are in its `definitions`")
    try:
        return defined_type(types, name, is_cdr=ros is not ROS1)
    except (KeyError, RecursionError, ValueError) as error:
        raise RecordingError(f"{type_name}: its definition cannot be used: {described(error)}") from None


@cache
def defined_type(types: Typestore, name: str, *, is_cdr: bool) -> MessageType:
    """Return a type as rosbags has it. Args: name: such as "nav_msgs/msg/Odometry".

    Raises: ValueError, KeyError, RecursionError: it cannot be read.
    """
    made = MessageType(name.replace("/msg/", "/"), is_cdr=is_cdr)
    attributes: Any
    _, attributes = types.fielddefs[name]
    for key, description in attributes:
        if not is_cdr and key == _NOTHING:
            continue
        kind, of = description
        count = -1
        if kind in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            (kind, of), length = of
            count = length if description[0] == Nodetype.ARRAY else 0
        if kind == Nodetype.BASE:
            attribute = of[0]
        else:
            attribute = "time" if of in _TIMES else defined_type(types, of, is_cdr=is_cdr)
        # The matrices of sensor_msgs/CameraInfo have capitals in ROS 1 alone.
        made.add(key.lower(), attribute, count)
    return made


@cache
def bag_typestore(ros: Stores = ROS1) -> Typestore:
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
    for kind, sensor in KINDS.items():
        for type_name, definition in sensor.definitions.items():
            try:
                typestore.register(get_types_from_msg(definition, type_name.replace("/", "/msg/")))
            except Exception as error:  # rosbags turns definitions into Python code: any error of that
                what = f"sensors of kind {kind}: the definition of {type_name} cannot be read: {described(error)}"
                raise RecordingError(what) from None
    return typestore


@cache
def _message_files() -> tuple[Path, ...]:
    for root in share_roots():
        if files := sorted((root / "msg").glob("*.msg")):
            return tuple(files)
    places = ", ".join(str(root / "msg") for root in share_roots())
    raise RecordingError(f"{places}: no message definitions found; is robotteamsim installed completely?")
