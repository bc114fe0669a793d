"""The topics from which the path of each robot in a bag is read."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import NamedTuple

TRUTH, ODOM = "base_pose_ground_truth", "odom"
SOURCES = {
    "nav_msgs/Odometry": "odom",
    "geometry_msgs/PoseStamped": "pose",
    "geometry_msgs/PoseWithCovarianceStamped": "pose",
}
"""Where a path comes from, by the type of the topic."""
TF_TYPES = ("tf2_msgs/TFMessage", "tf/tfMessage")
"""Have the same fields; the second one is of old programs, and of rosserial."""

_FILTERED = "odometry/filtered"
"""Of robot_localization."""


class PathTopic(NamedTuple):
    """The topic of a robot's poses. source: "truth", "odom", "pose" or "tf"."""

    name: str
    source: str


def path_topics(topics: Mapping[str, str], chosen: Sequence[str] = ()) -> dict[str, PathTopic]:
    """Return the topic of the poses of each robot by its namespace, in natural order: robot_2 before robot_10.

    The first of these that a bag has: true poses, in each namespace else `odom`; `odometry/filtered`; other topics of
    odometry; poses, such as those of a motion capture system, but no goals.
    Args:   topics: the types of all topics of the bag. chosen: the topics to take instead.
    Raises: ValueError: a chosen topic is not in the bag, or has no poses, or several in a namespace are possible.
    """
    found = list(dict.fromkeys(chosen)) or _found(topics)
    for topic in found:
        if topics.get(topic) not in SOURCES:
            known = ", ".join(name for name, kind in topics.items() if kind in SOURCES) or "none"
            what = f"is of type {topics[topic]}" if topic in topics else "is not in the bag"
            raise ValueError(f"--odometry {topic}: {what}; expected a topic with poses: {known}")
    # Where several topics share a namespace, each robot is named as its topic.
    counts = Counter(map(_namespace, found))
    by_namespace = {_namespace(topic) if counts[_namespace(topic)] == 1 else topic: topic for topic in found}
    return {
        name: PathTopic(topic, "truth" if _last(topic) == TRUTH else SOURCES[topics[topic]])
        for name, topic in sorted(by_namespace.items(), key=lambda item: natural(item[0]))
    }


def _found(topics: Mapping[str, str]) -> list[str]:
    odometry = [topic for topic, kind in topics.items() if SOURCES.get(kind) == "odom"]
    if named := [topic for topic in odometry if _last(topic) in (TRUTH, ODOM)]:
        truths = {_namespace(topic) for topic in named if _last(topic) == TRUTH}
        return [topic for topic in named if _last(topic) == TRUTH or _namespace(topic) not in truths]
    odometry = [topic for topic in odometry if topic.endswith(f"/{_FILTERED}")] or odometry
    counts = Counter(map(_namespace, odometry))
    if several := [topic for topic in odometry if counts[_namespace(topic)] > 1]:
        raise ValueError(f"{', '.join(several)}: several odometries of a robot; choose with --odometry")
    return odometry or [topic for topic, kind in topics.items() if _has_path(topic, kind)]


def left_out(topics: Mapping[str, str], paths: Mapping[str, PathTopic]) -> list[str]:
    """Return the topics of odometry and poses in namespaces without a path: each may be of one more robot."""
    used = {_namespace(path.name) for path in paths.values()}
    return [topic for topic, kind in topics.items() if _has_path(topic, kind) and _namespace(topic) not in used]


def _has_path(topic: str, kind: str) -> bool:
    is_pose = kind == "geometry_msgs/PoseStamped" and "goal" not in topic.lower()
    return is_pose or SOURCES.get(kind) == "odom"


def natural(name: str) -> list[str | int]:
    """Return a key that sorts the numbers in names as numbers."""
    return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", name)]


def _last(topic: str) -> str:
    return topic.rpartition("/")[2]


def _namespace(topic: str) -> str:
    return topic.removesuffix(f"/{_FILTERED}") if topic.endswith(f"/{_FILTERED}") else topic.rpartition("/")[0]
