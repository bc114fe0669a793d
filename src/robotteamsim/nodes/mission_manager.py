"""Judges a mission from topics alone, beside whatever moves the robots: the node `mission_manager`."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec
from rich.console import Console

from robotteamsim.analysis.runs.tables import print_totals
from robotteamsim.interface import Decision
from robotteamsim.network.messages import Message
from robotteamsim.nodes.inputs import Input
from robotteamsim.nodes.node import Node, Output
from robotteamsim.nodes.settings import Settings, read_seed
from robotteamsim.nodes.steps import Steps
from robotteamsim.recording import ResultWriter, TumWriter
from robotteamsim.recording.topics import Changes, Source, Topic, When
from robotteamsim.recording.topics.decisions import OUTBOX, STATUS
from robotteamsim.recording.topics.mission import MISSION_TOPICS
from robotteamsim.recording.topics.robots import CONTACT, TRUTH, ContactReading
from robotteamsim.recording.topics.world import ROBOTS, TeamPresence
from robotteamsim.simulation import Observer, StepRecord
from robotteamsim.simulation.judge import Judge

_NO_CONTACT = ContactReading()
_OF_ROBOT = (TRUTH, CONTACT, STATUS, OUTBOX)
"""What it needs of each robot; statuses and messages only of those that have a controller."""

logger = logging.getLogger(__name__)


class MissionManager:
    """Follows the robots of a world that publishes /world/robots, and publishes the mission below its own name.

    In lockstep its mission is that of the simulation, step by step. Otherwise a step has what has arrived by then.
    """

    def __init__(self, node: Node, settings: Settings) -> None:
        """Subscribe and advertise."""
        self._node, self._settings = node, settings
        out = node.parameter("~out", "")
        self._folder = Path(out).expanduser() if out else None
        self._stays = node.parameter("~stays", False)
        self._steps = Steps(ROBOTS.name, self._missing, logger.warning)
        node.on_shutdown(self._steps.close)
        ids = range(settings.num_robots)
        self._inputs = {(i, topic): Input.of(node, topic, settings, i) for i in ids for topic in _OF_ROBOT}
        self._outputs: dict[Topic, Output] = {
            topic: node.output(f"~{topic.name.strip('/')}", topic.type_name, latched=settings.is_latched(topic))
            for topic in MISSION_TOPICS
            if topic.is_in(settings.scenario)
        }
        self._begin()
        for one in (Input.of(node, ROBOTS, settings), *self._inputs.values()):
            one.listen(self._steps.add)

    def serve(self) -> None:
        """Judge steps until the mission has ended (or longer, with `~stays`), or the node is shut down."""
        try:
            while (step := self._steps.take()) is not None:
                if step.restarted:
                    self._settings = read_seed(self._node, self._settings)
                    self._judge.trial.abandon()
                    self._begin()
                for values in step.each:
                    self._note(values)
                    if not self._missing(0, values) and self._judge.trial.result is None:
                        self._follow(values)
                if self._judge.trial.result is not None and not self._stays:
                    return
        finally:
            self._judge.trial.abandon()

    def _begin(self) -> None:
        observers: list[Observer] = []
        if self._folder is not None:
            observers = [TumWriter(self._folder / "trajectories"), ResultWriter(self._folder)]
        self._judge = Judge(self._settings.setup, observers)
        self._statuses = [Decision()] * self._settings.num_robots
        self._said: list[list[Message]] = [[] for _ in self._statuses]
        """What the robots have sent since the last step."""
        self._source, self._changes = Source(self._settings.setup), Changes()

    def _missing(self, _: int, values: Mapping[str, Any]) -> list[str]:
        presence: TeamPresence | None = values.get(ROBOTS.name)
        if presence is None:
            return [ROBOTS.name]
        needed = _OF_ROBOT if self._settings.lockstep and self._settings.controllers != "none" else (TRUTH,)
        topics = (self._inputs[i, topic].topic for i, there in enumerate(presence.present) if there for topic in needed)
        return [topic for topic in topics if topic not in values]

    def _note(self, values: Mapping[str, Any]) -> None:
        """Note what controllers have said, also for a step that was judged before."""
        for robot_id, said in enumerate(self._said):
            said += values.get(self._inputs[robot_id, OUTBOX].topic, ())
            self._statuses[robot_id] = values.get(self._inputs[robot_id, STATUS].topic, self._statuses[robot_id])

    def _follow(self, values: Mapping[str, Any]) -> None:
        """Judge a step. Args: values: by topic."""
        present = values[ROBOTS.name].present
        truths = [values[self._inputs[i, TRUTH].topic] if is_there else None for i, is_there in enumerate(present)]
        contacts = [values.get(self._inputs[i, CONTACT].topic, _NO_CONTACT) for i in range(len(present))]
        team = zip(self._statuses, self._said, strict=True)
        decisions = [msgspec.structs.replace(status, outbox=tuple(said)) for status, said in team]
        self._said = [[] for _ in self._said]
        poses = [truth and truth.pose for truth in truths]
        self._publish(self._judge.follow(poses, [contact.in_contact for contact in contacts], decisions))
        if (result := self._judge.trial.result) is not None:
            print_totals(Console(), result, [self._folder])

    def _publish(self, record: StepRecord) -> None:
        for topic, output in self._outputs.items():
            if output.wanted and (topic.when is not When.CHANGE or self._changes.note(topic, record)):
                for message in topic.messages(record.sim_time_ns, topic.values(self._source, record)):
                    output.publish(message)
        for event in record.events:
            logger.info("%.1f s: %s", event.time_s, event.detail)
