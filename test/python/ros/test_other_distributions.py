"""Whether nodes of other distributions of ROS understand the topics: standard messages have their definitions."""

from __future__ import annotations

import importlib
import re
from pathlib import Path

import pytest
from rosbags.typesys import Stores, get_typestore

DOCS = Path(__file__).parents[3] / "docs"
TABLES, _, _ = (DOCS / "ros_api.md").read_text(encoding="utf-8").partition("## Frames")
TOPICS = sorted(set(re.findall(r"\| ((?:\w+_msgs)/\w+)[ ,]", TABLES)))


def test_topics_are_of_the_messages_that_nodes_of_other_people_know():
    assert {"nav_msgs/Odometry", "sensor_msgs/LaserScan", "geometry_msgs/Twist"} <= set(TOPICS)


@pytest.mark.parametrize("topic_type", TOPICS)
def test_messages_have_the_md5_of_noetic(topic_type):
    package, name = topic_type.split("/")
    if package == "tf2_msgs":
        pytest.skip("rosbags has it in none of its stores of ROS 1")
    ours = getattr(importlib.import_module(f"{package}.msg"), name)
    _, md5 = get_typestore(Stores.ROS1_NOETIC).generate_msgdef(f"{package}/msg/{name}", ros_version=1)
    assert ours._md5sum == md5


@pytest.mark.parametrize("topic_type", TOPICS)
def test_messages_of_jazzy_have_the_attributes_of_humble_but_range(topic_type):
    humble, jazzy = (
        get_typestore(store).fielddefs[topic_type.replace("/", "/msg/")][1]
        for store in (Stores.ROS2_HUMBLE, Stores.ROS2_JAZZY)
    )
    added = [attribute for attribute in jazzy if attribute not in humble]
    assert [name for name, _ in added] == (["variance"] if topic_type == "sensor_msgs/Range" else [])
    assert [attribute for attribute in jazzy if attribute in humble] == list(humble)
