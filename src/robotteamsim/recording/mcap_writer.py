"""Writes an MCAP file of a headless run, for Foxglove, Lichtblick, Rerun and ROS 2."""

import os
from pathlib import Path
from typing import Any, Literal

from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.rosbag2 import StoragePlugin, Writer

from robotteamsim.recording.bag_types import ROS2
from robotteamsim.recording.ros_recorder import RosRecorder

SUFFIX = ".mcap"

_VERSION: Literal[8] = 8
"""Of rosbag2's metadata; ROS 2 Humble cannot read the form of quality of service in version 9."""

_QUEUE = 10
_UNLIMITED = QosTime(2147483647, 4294967295)


class McapWriter(RosRecorder):
    """Writes an MCAP file with the topics of `BagWriter` and ROS 2 messages, with the definitions of all types.

    rosbags writes a folder with one file and its metadata: `path`.active. At the end, the file becomes `path`. After a
    kill or a full disk, the folder stays, for `mcap recover`.
    """

    _ros = ROS2
    _rescue = "mcap recover {active} -o {path}"

    def __init__(self, path: Path, *, localized: bool = False) -> None:
        """Args: as of `RosRecorder`."""
        super().__init__(path, localized=localized)
        self._active = self._temporary / f"{self._temporary.name}{SUFFIX}"

    def _new_writer(self) -> Writer:
        return Writer(self._temporary, version=_VERSION, storage_plugin=StoragePlugin.MCAP)

    def _is_ours(self) -> bool:
        ours = {self._active.name, "metadata.yaml", "metadata.yaml.tmp"}
        return self._temporary.is_dir() and ours.issuperset(os.listdir(self._temporary))

    def _settings(self, *, latched: bool) -> dict[str, Any]:
        return {"offered_qos_profiles": [_quality(latched=latched)]}


def _quality(*, latched: bool) -> Qos:
    """Return the quality of service; ROS 2 keeps the last message of a latched topic for later subscribers."""
    return Qos(
        history=QosHistory.KEEP_LAST,
        depth=1 if latched else _QUEUE,
        reliability=QosReliability.RELIABLE,
        durability=QosDurability.TRANSIENT_LOCAL if latched else QosDurability.VOLATILE,
        deadline=_UNLIMITED,
        lifespan=_UNLIMITED,
        liveliness=QosLiveliness.AUTOMATIC,
        liveliness_lease_duration=_UNLIMITED,
        avoid_ros_namespace_conventions=False,
    )
