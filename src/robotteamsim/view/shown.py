"""A mission that is simulated while viewers watch it: what each of them receives."""

from __future__ import annotations

import threading
from typing import Any

import msgspec

from robotteamsim.hazards import HazardField
from robotteamsim.simulation import Simulation, StepRecord
from robotteamsim.view.document import header
from robotteamsim.view.frame import Frame, ShownEvent, fallen_of, frame_of, shown_events
from robotteamsim.view.html import mission_page, size_problem
from robotteamsim.view.layers import Film, LayerMap, field_layer, hazard_layers
from robotteamsim.view.recorder import FOUND, FrameRecorder, Recording, found_name

_RADIO_SIM_S = 1.0
"""Simulated time between maps of the radio coverage [s]."""

LEAST_SPEED, MOST_SPEED = 0.001, 1000.0
"""Of a mission that is watched: simulated over wall time."""

FRAME_WALL_S = 1.0 / 15.0
"""Least time between frames that are sent [s]."""

_MOST_LINKS = 5_000_000
"""Of all frames that are kept for a page that a viewer may save."""

FIRST_LAYERS = frozenset(("fire", "smoke", "belief"))
"""Those that a new viewer shows."""


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


class ShownMission:
    """What has been simulated of a mission, for any number of viewers; a subclass simulates and executes commands."""

    def __init__(self, *, speed: float, playing: bool) -> None:
        """Args: speed: simulated over wall time. Raises: ValueError: it is out of range."""
        if not isinstance(speed, (int, float)) or not LEAST_SPEED <= speed <= MOST_SPEED:
            raise ValueError(f"speed: {speed!r:.60}; expected {LEAST_SPEED:g} to {MOST_SPEED:g}")
        self._speed, self._playing, self._error = speed, playing, ""
        self._viewers: list[Viewer] = []
        self._num_viewers = 0
        """All that ever watched."""
        self._changed = threading.Condition()
        """Held by the thread that uses what follows, except while a page waits for a version or a step for its time."""
        self._version = self._missions = 0
        self.is_closed = False
        """Whether nothing more will happen."""

    def execute(self, command: Any) -> None:
        """Execute a command of a viewer. Raises: RobotTeamSimError, ValueError: it is not possible."""
        raise NotImplementedError

    def page(self) -> str:
        """Return the mission so far as a page, as `run --html` writes it. Raises: ValueError: it would be too large."""
        with self._changed:  # the mission waits meanwhile
            if self._too_large:
                raise ValueError(self._too_large)
            return mission_page([self._recorder.recording], self._recorder.recording.title)

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
            self._changed.notify_all()

    def take(self, viewer: Viewer, timeout_s: float) -> Update | None:
        """Return what has happened since the last call; None if nothing happens before the timeout, or the end.

        The first update of a viewer contains the scene.
        """
        with self._changed:
            self._changed.wait_for(lambda: viewer.version != self._version or self.is_closed, timeout_s)
            if viewer.version == self._version:
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
            if _chosen(name) in viewer.layers and viewer.maps.get(name) != version:
                viewer.maps[name] = version
                layers[name] = document
        scene = self._header if is_new else {}
        return Update(self._status(), events, frames, layers, viewer.number, restarted=is_new, **scene)

    def _begin_with(self, simulation: Simulation, recorder: FrameRecorder, record: StepRecord) -> None:
        """Show a simulation from now on. Args: recorder: a new one.  record: of its first step that is shown."""
        scenario = simulation.scenario  # with the places of random victims
        shown = Recording(recorder.recording.scene, f"{scenario.name}, seed {scenario.run.seed}")
        # All that can fail comes before this, so that a failed restart changes nothing.
        self._simulation, self._recorder, self._header = simulation, recorder, header(shown)
        self._too_large = size_problem(simulation.setup, _MOST_LINKS)
        self._missions += 1
        self._events: list[ShownEvent] = []
        self._fallen: frozenset[str] = frozenset()
        self._frames: list[Frame] = []
        """Those that were published; only the last one may have scans."""
        self._maps: dict[str, tuple[int, dict[str, Any] | None]] = {}
        """The last map of each layer that somebody has shown, with its version."""
        self._hazards: HazardField | None = None
        self._found: dict[str, LayerMap] = {}
        """The maps of robots that were not published yet."""
        self._radio_s, self._voice_version = -_RADIO_SIM_S, -1
        self._note(record)

    def _set_layers(self, number: int, layers: list[str]) -> None:
        for viewer in self._viewers:
            if viewer.number == number:
                viewer.layers = frozenset(layers)

    def _note(self, record: StepRecord) -> None:
        self._record = record
        if not self._too_large:
            self._recorder.step(record)
        self._events += shown_events(record.events, record.mission.time_s)
        self._fallen |= fallen_of(record.events)
        if record.hazards is not None:
            self._hazards = record.hazards
        maps = self._recorder.new_found(record)
        self._found |= {found_name(robot_id): layer for robot_id, layer in maps if layer is not None}

    def _publish(self) -> None:
        """Let all viewers take the latest frame, and the events and maps that are new."""
        shown = frozenset[str]().union(*(viewer.layers for viewer in self._viewers))
        record, setup = self._simulation.look(self._record), self._simulation.setup
        sensors = self._recorder.sensors
        frame = frame_of(record, setup, with_scans="laser" in shown, fallen=self._fallen, sensors=sensors)
        if self._frames:
            last = self._frames.pop()
            self._frames += [] if last.time_s == frame.time_s else [msgspec.structs.replace(last, scans_m=())]
        self._frames.append(frame)
        self._version += 1
        for name, layer in self._new_maps(shown).items():
            self._maps[name] = self._version, Film([layer]).packed()
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
            maps |= {"radio": coverage[0]} if (coverage := self._recorder.coverage.at(self._frames[-1])) else {}
        if "belief" in shown:
            maps |= self._found
            self._found = {}
        if self._hazards is not None and not shown.isdisjoint(("fire", "smoke")):
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


def _chosen(name: str) -> str:
    """Return which of SetLayers shows a map. Args: name: of the map."""
    return "belief" if name.startswith(FOUND) else name
