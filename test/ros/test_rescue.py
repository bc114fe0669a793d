"""Firefighters, their command centre and people who move: the same mission in ROS as without it."""

from __future__ import annotations

import json

import pytest
from rosbags.rosbag1 import Reader
from running import ROSLAUNCH, running

from robotteamsim.mission.events import Event
from robotteamsim.recording import BagWriter
from robotteamsim.recording.results import EventList
from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation


def shown(events: list[Event]) -> list[tuple[float, str, str, int, str]]:
    return [(e.time_s, e.kind, e.subject, e.robot_id, e.detail) for e in events]


@pytest.mark.parametrize(("name", "time_s", "hosted"), [("garage_rescue", 36, "nodes"), ("office_fire", 49, "team")])
def test_rescue_in_lockstep_has_the_bits_events_and_topics_of_the_headless_mission(name, time_s, hosted, tmp_path):
    settings = (f"mission.time_limit_s={time_s}", "network.publish_matrices=false")
    command = (
        *ROSLAUNCH,
        "robotteamsim",
        "mission.launch",
        f"scenario:={name}",
        "rviz:=false",
        "lockstep:=true",
        "speed:=0",
    )
    options = (f"controllers:={hosted}", "out:=results", "record:=true", "bag:=run.bag")
    with running((*command, f"set:={' '.join(settings)}", *options), tmp_path) as program:
        assert program.wait() == 0, program.output
    found = json.loads((tmp_path / "results" / "mission.json").read_text())
    events = EventList()
    headless = Simulation(load(name, list(settings))).run([events, BagWriter(tmp_path / "headless.bag")])
    assert found["result"]["trajectory_hash"] == headless.trajectory_hash
    assert [tuple(event.values()) for event in found["events"]] == shown(events.events)
    assert any(event.kind == "victim_reported" for event in events.events)
    with Reader(tmp_path / "run.bag") as recorded, Reader(tmp_path / "headless.bag") as written:
        counts = [{c.topic: c.msgcount for c in bag.connections} for bag in (recorded, written)]
    assert counts[0] == counts[1]
    assert counts[0]["/world/people"] > 0


@pytest.mark.parametrize("hosted", ["nodes", "inside"])
def test_people_alone_in_lockstep_have_the_events_and_egress_of_the_headless_mission(hosted, tmp_path):
    settings = "mission.time_limit_s=50"
    command = (*ROSLAUNCH, "robotteamsim", "mission.launch", "scenario:=office_egress", "rviz:=false", "lockstep:=true")
    with running((*command, "speed:=0", f"set:={settings}", f"controllers:={hosted}", "out:=out"), tmp_path) as program:
        assert program.wait() == 0, program.output
    found = json.loads((tmp_path / "out" / "mission.json").read_text())
    events = EventList()
    headless = Simulation(load("office_egress", [settings])).run([events])
    assert found["result"]["trajectory_hash"] == headless.trajectory_hash
    assert [tuple(event.values()) for event in found["events"]] == shown(events.events)
    assert found["result"]["egress"]["out"] == headless.egress.num_out
    assert sum(headless.egress.num_out.values()) > 10
