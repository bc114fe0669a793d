"""A mission that runs at a chosen speed while viewers watch it and interfere."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Annotated, Any

import msgspec

from robotteamsim.hazards import HazardField
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.simulation import Simulation, StepRecord
from robotteamsim.view.document import film, header
from robotteamsim.view.frame import Frame, ShownEvent, fallen_of, frame_of, shown_events
from robotteamsim.view.layers import LayerMap, field_layer, hazard_layers
from robotteamsim.view.recorder import RadioCoverage, Recording
from robotteamsim.view.scene import scene_of

logger = logging.getLogger(__name__)

_FRAME_WALL_S = 1.0 / 15.0
"""Least time between frames that are sent [s]."""

_RADIO_SIM_S = 1.0
"""Simulated time between maps of the radio coverage [s]."""

_BREAK_S = 1e-4
"""Least time between the steps of two frames, in which commands are executed [s]."""

FIRST_LAYERS = frozenset(("fire", "smoke"))
"""Those that a new viewer shows."""

Coordinate = Annotated[float, msgspec.Meta(ge=-1e6, le=1e6)]


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

    speed: Annotated[float, msgspec.Meta(gt=0.0, le=1000.0)]


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


class SetLayers(Command, tag="set_layers"):
    """Send one viewer these layers, of fire, smoke, voice, radio and laser."""

    viewer: int
    layers: list[str]


AnyCommand = Play | Pause | Step | SetSpeed | Restart | SetNoise | SetDoor | SetVictim | SetLayers


class Update(msgspec.Struct):
    """What a viewer receives: what has happened since the last update.

    frames:    those that are new, in order; the first one replaces a frame of the same time.
    layers:    maps that have changed, by name.
    viewer:    the number of this viewer, for SetLayers.
    restarted: a mission has begun, or this viewer is new; then title, scene and palette are set.
    """

    status: dict[str, Any]
    events: list[ShownEvent]
    frames: list[Frame]
    layers: dict[str, dict[str, Any] | None]
    viewer: int
    restarted: bool = False
    title: str = ""
    scene: Any = None
    palette: Any = None


class Viewer:
    """One who watches a mission: the layers that they show, and what they have received of it.

    missions, frames, events: how many.  maps: the version of each layer.
    """

    def __init__(self, number: int) -> None:
        self.number = number
        self.layers = FIRST_LAYERS
        self.missions = self.frames = self.events = self.version = 0
        self.maps: dict[str, int] = {}


class LiveMission:
    """Runs a mission in a thread of its own."""

    def __init__(self, load: Callable[[int | None], Scenario], *, speed: float, playing: bool) -> None:
        """Args: load: returns the scenario, with another seed unless it is None.  speed: simulated over wall time.

        Raises: RobotTeamSimError: the scenario cannot be simulated.
        """
        self._load, self._speed, self._playing = load, speed, playing
        self._viewers: list[Viewer] = []
        self._num_viewers = 0
        """All that ever watched; the mission begins with the first."""
        self._changed = threading.Condition()
        """Held by the thread that uses what follows, except while a page waits for a version or a step for its time."""
        self._version = self._missions = 0
        self._is_closed = False
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
            self._is_closed = True
            self._changed.notify_all()
        self._thread.join()
        self._stepper.submit(self._simulation.world.close_cameras)
        self._stepper.shutdown()

    def execute(self, command: AnyCommand) -> None:
        """Execute a command between two steps. Raises: RobotTeamSimError, ValueError: it is not possible."""
        with self._changed:
            self._execute(command)
            self._publish()

    def subscribe(self) -> Viewer:
        """Return a new viewer."""
        with self._changed:
            self._num_viewers += 1
            self._viewers.append(Viewer(self._num_viewers))
            self._changed.notify_all()
            return self._viewers[-1]

    def unsubscribe(self, viewer: Viewer) -> None:
        """End the updates of a viewer."""
        with self._changed:
            self._viewers.remove(viewer)

    def take(self, viewer: Viewer, timeout_s: float) -> Update | None:
        """Return what has happened since the last call; None if nothing happens before the timeout.

        The first update of a viewer contains the scene.
        """
        with self._changed:
            if not self._changed.wait_for(lambda: viewer.version != self._version, timeout_s):
                return None
            viewer.version = self._version
            return self._update(viewer)

    def _update(self, viewer: Viewer) -> Update:
        is_new = viewer.missions != self._missions
        if is_new:
            viewer.missions, viewer.frames, viewer.events, viewer.maps = self._missions, 0, 0, {}
        # A command may have changed the last frame that the viewer has.
        frames = self._frames[max(viewer.frames - 1, 0) :]
        if "laser" not in viewer.layers:
            frames[-1] = msgspec.structs.replace(frames[-1], scans_m=())
        events = self._events[viewer.events :]
        viewer.frames, viewer.events = len(self._frames), len(self._events)
        layers = {}
        for name, (version, document) in self._maps.items():
            if name in viewer.layers and viewer.maps.get(name) != version:
                viewer.maps[name] = version
                layers[name] = document
        scene = self._header if is_new else {}
        return Update(self._status(), events, frames, layers, viewer.number, restarted=is_new, **scene)

    def _begin(self, seed: int | None) -> None:
        scenario = self._load(seed)
        simulation = Simulation(scenario)
        scenario = simulation.scenario  # with the places of random victims
        simulation.mission.start()
        recording = Recording(scene_of(simulation.setup), f"{scenario.name}, seed {scenario.run.seed}")
        coverage = RadioCoverage(scenario)
        record = self._stepper.submit(simulation.step).result()
        # All that can fail comes before this, so that a failed restart changes nothing.
        self._simulation, self._coverage, self._header = simulation, coverage, header(recording)
        self._missions += 1
        self._error = ""
        self._events: list[ShownEvent] = []
        self._fallen: frozenset[str] = frozenset()
        self._frames: list[Frame] = []
        """Those that were published; only the last one may have scans."""
        self._maps: dict[str, tuple[int, dict[str, Any] | None]] = {}
        """The last map of each layer that somebody has shown, with its version."""
        self._hazards: HazardField | None = None
        self._radio_s, self._voice_version = -_RADIO_SIM_S, -1
        self._note(record)
        self._publish()

    def _is_running(self) -> bool:
        return self._playing and self._num_viewers > 0 and self._record.mission.state != "ended"

    def _run(self) -> None:
        due_s = frame_s = time.perf_counter()
        with self._changed:
            while not self._is_closed:
                if not self._is_running():
                    self._changed.wait()
                    due_s = time.perf_counter()
                    continue
                wanted_s = max(due_s, frame_s)
                self._changed.wait(max(wanted_s - time.perf_counter(), _BREAK_S))
                begin_s = time.perf_counter()
                if begin_s < wanted_s:  # a command was executed
                    continue
                frame_s = begin_s + _FRAME_WALL_S
                while self._is_running() and due_s <= time.perf_counter() < frame_s:
                    due_s += self._simulation.scenario.run.step_s / self._speed
                    try:
                        self._step()
                    except Exception as error:  # its viewers see one line, the log has all
                        logger.debug("the mission is paused", exc_info=True)
                        self._playing, self._error = False, f"{type(error).__name__}: {error}"
                due_s = max(due_s, begin_s)  # a machine that is too slow does not catch up
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
            case SetNoise(noise_db):
                simulation.set_noise_db(noise_db)
            case SetDoor(name, closed):
                simulation.set_door(name, closed)
            case SetVictim(name, position_m):
                simulation.set_victim(name, position_m)
            case SetLayers(number, layers):
                for viewer in self._viewers:
                    if viewer.number == number:
                        viewer.layers = frozenset(layers)
            case Restart(seed):
                self._stepper.submit(self._simulation.world.close_cameras)
                self._begin(seed)

    def _step(self) -> None:
        if self._record.mission.state != "ended":
            self._note(self._stepper.submit(self._simulation.step).result())

    def _note(self, record: StepRecord) -> None:
        self._record = record
        self._events += shown_events(record.events, record.mission.time_s)
        self._fallen |= fallen_of(record.events)
        if record.hazards is not None:
            self._hazards = record.hazards

    def _publish(self) -> None:
        """Let all viewers take the latest frame, and the events and maps that are new."""
        shown = frozenset[str]().union(*(viewer.layers for viewer in self._viewers))
        frame = frame_of(self._record, self._simulation, with_scans="laser" in shown, fallen=self._fallen)
        if self._frames:
            last = self._frames.pop()
            self._frames += [] if last.time_s == frame.time_s else [msgspec.structs.replace(last, scans_m=())]
        self._frames.append(frame)
        self._version += 1
        for name, layer in self._new_maps(shown).items():
            self._maps[name] = self._version, film([layer])
        self._changed.notify_all()

    def _new_maps(self, shown: frozenset[str]) -> dict[str, LayerMap]:
        """Return the maps that somebody shows and that have changed, by name."""
        maps: dict[str, LayerMap] = {}
        time_s, voice = self._record.mission.time_s, self._simulation.hearing.sensor
        if "voice" in shown and voice.version != self._voice_version:
            self._voice_version = voice.version
            maps["voice"] = field_layer(time_s, voice.map(), 0.0)
        if "radio" in shown and time_s - self._radio_s >= _RADIO_SIM_S:
            self._radio_s = time_s
            maps |= {"radio": coverage[0]} if (coverage := self._coverage.at(self._frames[-1])) else {}
        if self._hazards is not None and not shown.isdisjoint(FIRST_LAYERS):
            maps |= hazard_layers(time_s, self._hazards)
            self._hazards = None
        return maps

    def _status(self) -> dict[str, Any]:
        return {
            "playing": self._playing,
            "speed": self._speed,
            "seed": self._simulation.scenario.run.seed,
            "noise_db": self._simulation.mission.noise_db,
            "error": self._error,
        }
