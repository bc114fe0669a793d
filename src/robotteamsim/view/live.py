"""A mission that runs at a chosen speed while viewers watch it and interfere."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Annotated, Any

import msgspec

from robotteamsim.geometry import Pose
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.simulation import Simulation
from robotteamsim.view.driven import DrivenRobots
from robotteamsim.view.recorder import FrameRecorder
from robotteamsim.view.shown import FRAME_WALL_S, LEAST_SPEED, MOST_SPEED, ShownMission
from robotteamsim.wording import described

logger = logging.getLogger(__name__)

_BREAK_S = 1e-4
"""Least time between the steps of two frames, in which commands are executed [s]."""

Coordinate = Annotated[float, msgspec.Meta(ge=-1e6, le=1e6)]
Share = Annotated[float, msgspec.Meta(ge=-1.0, le=1.0)]


class Command(msgspec.Struct, tag_field="command", forbid_unknown_fields=True):
    """What a viewer may ask for."""


class Play(Command, tag="play"):
    """Go on."""


class Pause(Command, tag="pause"):
    """Stop after this step."""


class Step(Command, tag="step"):
    """Make one step, and pause."""


class SetSpeed(Command, tag="set_speed"):
    """Set the simulated time per wall time."""

    speed: Annotated[float, msgspec.Meta(ge=LEAST_SPEED, le=MOST_SPEED)]


class Restart(Command, tag="restart"):
    """Begin again with a seed."""

    seed: Annotated[int, msgspec.Meta(ge=0, le=2**53)]


class SetNoise(Command, tag="set_noise"):
    """Set the background noise [dB]; the simulation checks its range."""

    noise_db: float


class SetDoor(Command, tag="set_door"):
    """Open or close a door."""

    name: str
    closed: bool


class SetVictim(Command, tag="set_victim"):
    """Add or move a victim [m, map]."""

    name: str
    position_m: tuple[Coordinate, Coordinate]


class SpawnRobot(Command, tag="spawn_robot"):
    """Add a robot that is absent, at a place [m, map], or else at its start."""

    robot: int
    position_m: tuple[Coordinate, Coordinate] | None = None


class Drive(Command, tag="drive"):
    """Drive a robot by hand until it is released; shares of its greatest speeds, forward and to the left."""

    robot: int
    forward: Share
    turn: Share


class SetGoal(Command, tag="set_goal"):
    """Let a robot drive to a goal [m, map], and wait there until it is released."""

    robot: int
    position_m: tuple[Coordinate, Coordinate]


class Release(Command, tag="release"):
    """Leave a robot to its controller again."""

    robot: int


class SetLayers(Command, tag="set_layers"):
    """Send one viewer these layers, of fire, smoke, belief, voice, radio and laser."""

    viewer: int
    layers: list[str]


ChangeOfRobot = SpawnRobot | Drive | SetGoal | Release
AnyCommand = Play | Pause | Step | SetSpeed | Restart | SetNoise | SetDoor | SetVictim | SetLayers | ChangeOfRobot


class LiveMission(ShownMission):
    """Runs a mission in a thread of its own, from the first viewer on."""

    def __init__(self, load: Callable[[int | None], Scenario], *, speed: float, playing: bool) -> None:
        """Args: load: returns the scenario, with another seed unless it is None.  speed: simulated over wall time.

        Raises: RobotTeamSimError: the scenario cannot be simulated.  ValueError: the speed is out of range.
        """
        super().__init__(speed=speed, playing=playing)
        self._load = load
        self._due_s = 0.0
        """When the next step is due [s, wall]."""
        self._ended = ""
        """Why the thread has ended without being told to; "" while it runs."""
        # The OpenGL context of a camera belongs to the thread that drew its first image.
        self._stepper = ThreadPoolExecutor(1, "steps")
        with self._changed:
            self._begin(None)
        self._thread = threading.Thread(target=self._run, daemon=True, name="mission")

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def close(self) -> None:
        """End the thread."""
        with self._changed:
            self.is_closed = True
            self._changed.notify_all()
        self._thread.join()
        self._stepper.submit(self._simulation.world.close_cameras)
        self._stepper.shutdown()

    def execute(self, command: AnyCommand) -> None:
        """Execute a command between two steps. Raises: RobotTeamSimError, ValueError: it is not possible."""
        with self._changed:
            if self._ended:
                raise ValueError(self._ended)
            self._execute(command)
            self._publish()

    def _begin(self, seed: int | None) -> None:
        simulation = Simulation(self._load(seed))
        simulation.mission.start()
        recorder = FrameRecorder(simulation.setup)
        record = self._stepper.submit(simulation.step).result()
        self._begin_with(simulation, recorder, record)
        self._driven, self._error = DrivenRobots(simulation), ""
        self._publish()

    def _status(self) -> dict[str, Any]:
        return super()._status() | {"driven": dict(self._driven.goals)}

    def _is_running(self) -> bool:
        return self._playing and self._num_viewers > 0 and self._record.mission.state != "ended"

    def _run(self) -> None:
        try:
            self._make_steps()
        except BaseException as error:  # SystemExit of a library would end this thread, and nobody would know why
            logger.debug("the thread of the mission has ended", exc_info=True)
            with self._changed:
                again = "start `robotteamsim view` again"
                self._playing, self._ended = False, f"the mission has ended unexpectedly: {described(error)}; {again}"
                self._error = self._ended
                self._version += 1
                self._changed.notify_all()

    def _make_steps(self) -> None:
        self._due_s = frame_s = time.perf_counter()
        with self._changed:
            while not self.is_closed:
                if not self._is_running():
                    self._changed.wait()
                    self._due_s = time.perf_counter()
                    continue
                wanted_s = max(self._due_s, frame_s)
                self._changed.wait(max(wanted_s - time.perf_counter(), _BREAK_S))
                begin_s = time.perf_counter()
                if begin_s < wanted_s:  # a command was executed
                    continue
                frame_s = begin_s + FRAME_WALL_S
                while self._is_running() and self._due_s <= time.perf_counter() < frame_s:
                    self._due_s += self._simulation.scenario.run.step_s / self._speed
                    try:
                        self._step()
                    except Exception as error:  # its viewers see one line, the log has all
                        logger.debug("the mission is paused", exc_info=True)
                        self._playing, self._error = False, f"{type(error).__name__}: {error}"
                self._due_s = max(self._due_s, begin_s)  # a machine that is too slow does not catch up
                self._publish()

    def _execute(self, command: AnyCommand) -> None:
        simulation = self._simulation
        match command:
            case Play():
                self._playing, self._error = True, ""
            case Pause():
                self._playing = False
            case Step():
                self._playing = False
                self._step()
            case SetSpeed(speed):
                self._speed = speed
                # The next step of a slow mission may be minutes away.
                self._due_s = min(self._due_s, time.perf_counter() + simulation.scenario.run.step_s / speed)
            case SetNoise(noise_db):
                simulation.set_noise_db(noise_db)
            case SetDoor(name, closed):
                simulation.set_door(name, closed)
            case SetVictim(name, position_m):
                simulation.set_victim(name, position_m)
            case SpawnRobot(robot, position_m):
                simulation.spawn_robot(robot, position_m and Pose(*position_m, 0.0))
                self._driven.release(robot)
            case Drive(robot, forward, turn):
                self._driven.drive(robot, forward, turn)
            case SetGoal(robot, position_m):
                self._driven.set_goal(robot, position_m)
            case Release(robot):
                self._driven.release(robot)
            case SetLayers(number, layers):
                self._set_layers(number, layers)
            case Restart(seed):
                self._stepper.submit(self._simulation.world.close_cameras)
                self._begin(seed)

    def _step(self) -> None:
        if self._record.mission.state != "ended":
            self._driven.command(self._record)
            self._note(self._stepper.submit(self._simulation.step).result())
