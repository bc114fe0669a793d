"""The stage of the controllers in ROS: topics out, decisions in."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import Any

import msgspec

from robotteamsim.geometry import Twist
from robotteamsim.interface import Decision, Localisation
from robotteamsim.message_parts import robot_name
from robotteamsim.mission import Sensed
from robotteamsim.network.messages import Message
from robotteamsim.nodes.inputs import QUEUED, Input
from robotteamsim.nodes.node import Node
from robotteamsim.nodes.outputs import Decided, decision_outputs
from robotteamsim.nodes.settings import Settings
from robotteamsim.nodes.steps import REPORT_TIMEOUT_S
from robotteamsim.recording.topics import Topic
from robotteamsim.recording.topics.beliefs import FOUND_MAP, LOCALISATION, PARTICLES
from robotteamsim.recording.topics.decisions import COMMAND, OUTBOX, STAMPED_COMMAND, STATUS
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.simulation import TeamControllers

CHECK_PERIOD_S = 1.0
"""Interval of checks for silent controllers [s, wall]."""

ANSWERS = (STAMPED_COMMAND, OUTBOX, STATUS)
"""The topics by which a controller answers, with LOCALISATION if it localises the robot."""
SHOWN = {FOUND_MAP: "found", PARTICLES: "particles"}
"""What a robot believes, for display, and the field of `Decision` that has it; no step waits for these."""
Answer = tuple[int, Topic]
"""A robot's id, and one of these topics."""

STOP = Twist()

logger = logging.getLogger(__name__)


class CommandsByTopic:
    """The last `cmd_vel` of each robot; it holds for some time, then the robot stops."""

    def __init__(self, node: Node, settings: Settings, robots: Sequence[PlacedRobot]) -> None:
        """Subscribe."""
        # In lockstep and with the controllers inside, only robots driven by hand obey `cmd_vel`.
        is_free = settings.controllers in ("nodes", "team") and not settings.lockstep
        self._hold_ns = [round(robot.cmd_vel_hold_s * 1e9) for robot in robots]
        self._driven = [i for i in range(len(robots)) if is_free or settings.is_driven_by_hand(i)]
        self._received: dict[int, Twist] = {}
        """Those that have come since the last step."""
        self._held: dict[int, tuple[int, Twist]] = {}
        """The newest ones, with the time [ns] of the step from which on they hold."""
        self._changed = threading.Lock()
        for robot_id in self._driven:
            Input.of(node, COMMAND, settings, robot_id).listen(partial(self._receive, robot_id), QUEUED)

    def at(self, sim_time_ns: int) -> dict[int, Twist]:
        """Return the commands that hold at a time, by id of the robots that obey them."""
        with self._changed:
            self._held |= {robot_id: (sim_time_ns, twist) for robot_id, twist in self._received.items()}
            self._received.clear()
            holding = {
                i: twist for i, (begin_ns, twist) in self._held.items() if sim_time_ns - begin_ns < self._hold_ns[i]
            }
            return {robot_id: holding.get(robot_id, STOP) for robot_id in self._driven}

    def stop(self, robot_id: int) -> None:
        """Discard a robot's command."""
        with self._changed:
            self._received.pop(robot_id, None)
            self._held.pop(robot_id, None)

    def _receive(self, robot_id: int, _: str, __: int, twist: Twist) -> None:
        with self._changed:
            self._received[robot_id] = twist


class _Robot:
    """What the controller of a robot has answered."""

    def __init__(self) -> None:
        self.status = Decision()
        self.twist = STOP
        self.outbox: list[Message] = []
        self.localisation: Localisation | None = None
        """Of the current step."""
        self.shown: dict[str, Any] = {}
        """What came since the last step on the topics of SHOWN, by field."""


class ControllersByTopic:
    """Controllers that are nodes of their own. In lockstep each step waits for their answers.

    Otherwise a step waits for a moment, and uses the answers that have come by then.
    """

    def __init__(
        self,
        node: Node,
        settings: Settings,
        publish: Callable[[Sensed], None],
        patience_s: Callable[[], float],
    ) -> None:
        """Subscribe.

        Args: publish:    publishes the inputs of the controllers.
              patience_s: returns how long a step without lockstep waits for answers [s, wall].
        """
        self._settings = settings
        self._publish = publish
        self._patience_s = patience_s
        self._changed = threading.Condition()
        self._closed = False
        self._time_ns = 0
        self._waiting: set[Answer] = set()
        """The answers to the current step that have not come yet."""
        self._known: set[Answer] = set()
        """The answers that have come at least once."""
        self._silent: set[Answer] = set()
        self._robots = [_Robot() for _ in range(settings.num_robots)]
        self.faults = ("",) * settings.num_robots
        """As for all controllers: these publish theirs."""
        self._answers = (*ANSWERS, LOCALISATION) if LOCALISATION.is_in(settings.scenario) else ANSWERS
        shown = [topic for topic in SHOWN if topic.is_in(settings.scenario)]
        for topic in (*self._answers, *shown) if settings.mission else ():
            if topic is not STAMPED_COMMAND or settings.controlled:
                for robot_id in range(settings.num_robots):
                    Input.of(node, topic, settings, robot_id).listen(partial(self._receive, (robot_id, topic)))

    def wait_for_all(self, timeout_s: float) -> list[str]:
        """Wait until all controllers have started, with a timeout [s, wall]; return those that have not."""
        wanted = {(robot_id, STAMPED_COMMAND) for robot_id in self._settings.controlled}
        with self._changed:
            self._changed.wait_for(lambda: self._closed or wanted <= self._known, timeout_s)
            return [f"/{robot_name(robot_id)}/controller" for robot_id in sorted(i for i, _ in wanted - self._known)]

    def close(self) -> None:
        """End all waits; also from a signal handler, because the lock is reentrant."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()

    def step(self, sensed: Sensed) -> tuple[Decision, ...]:
        """As for all controllers."""
        with self._changed:
            self._time_ns = sensed.sim_time_ns
            expected = {(i, topic) for i in self._settings.controlled if sensed.present[i] for topic in self._answers}
            lockstep = self._settings.lockstep
            self._waiting = expected - self._silent if lockstep else expected & self._known
        self._publish(sensed)
        with self._changed:
            if lockstep:
                self._wait_for_answers()
            else:
                self._changed.wait_for(lambda: self._closed or not self._waiting, self._patience_s())
            return tuple(
                self._decision(robot_id) if sensed.present[robot_id] else self._forget(robot_id)
                for robot_id in range(len(self._robots))
            )

    def restart(self, _: Settings) -> None:
        """Forget all decisions, because time starts again."""
        with self._changed:
            self._robots = [_Robot() for _ in self._robots]
            self._time_ns = 0

    def _decision(self, robot_id: int) -> Decision:
        robot = self._robots[robot_id]
        outbox, robot.outbox = tuple(robot.outbox), []
        believed = {"localisation": robot.localisation, **robot.shown}
        robot.localisation, robot.shown = None, {}
        if not self._settings.lockstep or robot_id not in self._settings.controlled:
            return msgspec.structs.replace(robot.status, twist=robot.twist, outbox=outbox, **believed)
        missing = self._waiting | self._silent
        status = robot.status if (robot_id, STATUS) not in missing else Decision()
        twist = robot.twist if (robot_id, STAMPED_COMMAND) not in missing else STOP
        if silent := _names(answer for answer in self._silent if answer[0] == robot_id):
            too_slow = f"{', '.join(silent)}: silent for {self._settings.silence_limit_s:g} s"
            status = msgspec.structs.replace(status, fault=status.fault or too_slow)
        return msgspec.structs.replace(status, twist=twist, outbox=outbox, **believed)

    def _forget(self, robot_id: int) -> Decision:
        self._robots[robot_id] = _Robot()
        return Decision()

    def _wait_for_answers(self) -> None:
        """Wait for all answers but those of controllers that have been silent for too long."""
        begin_s, reported = time.monotonic(), False
        while self._waiting and not self._closed:
            self._changed.wait(CHECK_PERIOD_S)
            waited_s = time.monotonic() - begin_s
            if self._waiting and self._waiting <= self._known and waited_s >= self._settings.silence_limit_s:
                for name in _names(self._waiting):
                    logger.warning("%s has been silent for %.0f s; continuing without it", name, waited_s)
                self._silent |= self._waiting
                return
            if self._waiting and not reported and waited_s > REPORT_TIMEOUT_S:
                reported = True
                logger.warning("waiting for %s", ", ".join(_names(self._waiting)))

    def _receive(self, answer: Answer, _: str, stamp_ns: int, value: Any) -> None:
        robot_id, topic = answer
        with self._changed:
            self._known.add(answer)
            self._silent.discard(answer)
            if stamp_ns == 0:
                self._changed.notify_all()  # it has started
                return
            is_answer = stamp_ns == self._time_ns
            if robot_id in self._settings.controlled:
                is_of_former_run = stamp_ns > self._time_ns
                # No step waits for what is shown, which may come late.
                is_late = self._settings.lockstep and not is_answer and topic not in SHOWN
                if is_of_former_run or is_late:
                    return
            if is_answer or topic is not LOCALISATION:
                self._store(robot_id, topic, value)
            if is_answer:
                self._waiting.discard(answer)
                if topic is STATUS and value.fault:  # a stopped controller localises its robot no more
                    self._waiting.discard((robot_id, LOCALISATION))
                if not self._waiting:
                    self._changed.notify_all()

    def _store(self, robot_id: int, topic: Topic, value: Any) -> None:
        robot = self._robots[robot_id]
        if topic is STAMPED_COMMAND:
            robot.twist = value
        elif topic is OUTBOX:
            robot.outbox += value
        elif topic is LOCALISATION:
            robot.localisation = value
        elif topic in SHOWN:
            robot.shown[SHOWN[topic]] = value
        else:
            robot.status = value


class ControllersInside:
    """The controllers of the scenario in this process, with all their topics."""

    def __init__(self, node: Node, settings: Settings, publish: Callable[[Sensed], None]) -> None:
        """Advertise. Args: publish: publishes the inputs of the controllers."""
        self.restart(settings)
        self._publish = publish
        self._outputs = decision_outputs(node, settings, range(settings.num_robots))

    @property
    def faults(self) -> Sequence[str]:
        """As for all controllers."""
        return self._controllers.faults

    def restart(self, settings: Settings) -> None:
        """Go on with new controllers, because time starts again."""
        self._controllers = TeamControllers(settings.setup)

    def step(self, sensed: Sensed) -> tuple[Decision, ...]:
        """As for all controllers."""
        self._publish(sensed)
        decisions = self._controllers.step(sensed)
        self._outputs.publish(Decided(sensed.sim_time_ns, sensed.present, decisions, sensed.readings))
        return decisions


def _names(answers: Iterable[Answer]) -> list[str]:
    return sorted(f"/{robot_name(robot_id)}/{topic.name}" for robot_id, topic in answers)
