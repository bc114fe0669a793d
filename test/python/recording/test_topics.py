"""The table of topics, the names that sensors may not have, and the tables of docs/ros_api.md agree."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from robotteamsim.recording.topics import ROBOT_TOPICS, TEAM_TOPICS, Topic
from robotteamsim.scenario.sensors.base import is_free_name

PAGE = Path(__file__).parents[3] / "docs" / "ros_api.md"


def described() -> Iterator[tuple[str, str, str]]:
    """Yield topic, type and time of each row of the docs' tables of topics."""
    when = ""
    for line in PAGE.read_text(encoding="utf-8").partition("## Frames")[0].splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        names = re.findall(r"`([^`]+)`", cells[0].partition(" of ")[0].partition(", from")[0])
        types = re.findall(r"\w+_msgs/\w+|robotteamsim/\w+", cells[1]) if len(cells) > 1 else []
        if names and types:
            when = when if cells[-1] == "likewise" else cells[-1]
            for number, name in enumerate(names):
                yield name, types[min(number, len(types) - 1)], when


@pytest.mark.parametrize("topic", [*TEAM_TOPICS, *ROBOT_TOPICS], ids=lambda topic: topic.name)
def test_docs_have_the_type_and_the_time_of_a_topic(topic: Topic) -> None:
    [(type_name, when)] = [(type_name, when) for name, type_name, when in described() if name == topic.name]
    assert type_name == topic.type_name
    assert when.startswith(topic.when.value)
    assert when.endswith(", latched") == topic.latched


def test_docs_describe_no_topic_that_does_not_exist() -> None:
    known = {topic.name for topic in (*TEAM_TOPICS, *ROBOT_TOPICS)} | {"/scene/...", "/<level>/map"}
    names = {name for name, *_ in described()}
    assert {name for name in names if name.startswith("/")} <= known


@pytest.mark.parametrize("topic", ROBOT_TOPICS, ids=lambda topic: topic.name)
def test_no_sensor_takes_the_name_of_a_topic(topic: Topic) -> None:
    assert not is_free_name(topic.name.partition("/")[0])
