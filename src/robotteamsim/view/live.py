"""A mission that runs at a chosen speed while viewers watch it and interfere."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable, Collection, Mapping
from concurrent.futures import Future
from typing import Annotated, Any

import msgspec

from robotteamsim.hazards import HazardField
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.simulation import Simulation, StepRecord
from robotteamsim.view.columns import header, map_document
from robotteamsim.view.frame import Frame, ShownEvent, enclosed_of, fallen_of, frame_of, shown_events, victim_shapes
from robotteamsim.view.hazard_layers import fire_layer, smoke_layer
from robotteamsim.view.layer_map import LayerMap, layer_map
from robotteamsim.view.recorder import RadioCoverage, Recording
from robotteamsim.view.scene import scene_of

_FRAME_WALL_S = 1.0 / 15.0
"""Least time between frames that are sent [s]."""

_RADIO_SIM_S = 1.0
"""Simulated time between maps of the radio coverage [s]."""

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
    """Set the background noise [dB]."""

    noise_db: Annotated[float, msgspec.Meta(ge=0.0, le=200.0)]


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


class Watched(Command):
    """The mission begins with its first viewer; not for viewers to ask."""


AnyCommand = Play | Pause | Step | SetSpeed | Restart | SetNoise | SetDoor | SetVictim | SetLayers


class Update(msgspec.Struct):
    """What a viewer receives: what has happened since the last update.

    restarted: a mission has begun, or this viewer is new; then title, scene and palette are set.
    frames:    those that are new, in order.
    layers:    maps that have changed, by name.
    viewer:    the number of this viewer, for SetLayers.
    """

    status: dict[str, Any]
    events: list[ShownEvent]
    frames: list[Frame]
    layers: dict[str, dict[str, Any]]
    restarted: bool = False
    title: str = ""
    scene: Any = None
    palette: Any = None
    viewer: int = 0


class Subscription:
    """Updates for one viewer; what it has not fetched yet is merged.

    viewer: its number.  layers: those that it shows.
    """

    def __init__(self, viewer: int, first: Update) -> None:
        self.viewer = viewer
        self.layers = FIRST_LAYERS
        self._sent: set[str] = set()  # names of the maps that this viewer has
        self._pending: Update | None = None
        self._changed = threading.Condition()
        self.send(first, {}, ())

    def send(self, update: Update, maps: Mapping[str, LayerMap], changed: Collection[str]) -> None:
        """Add an update, with those maps that this viewer shows and does not have, and with scans if it shows them.

        Args: changed: names of the maps that differ from those of the last call.
        """
        if update.restarted:
            self._sent = set()
        new = [name for name in maps if name in self.layers and (name in changed or name not in self._sent)]
        self._sent.update(new)
        frames = update.frames
        if "laser" not in self.layers:
            frames = [msgspec.structs.replace(frame, scans_m=()) if frame.scans_m else frame for frame in frames]
        layers = {name: map_document(name, maps[name]) for name in new}
        self.put(msgspec.structs.replace(update, frames=frames, layers=layers, viewer=self.viewer))

    def show(self, layers: frozenset[str]) -> None:
        """Choose the layers; maps of those that were hidden are sent again."""
        self.layers = layers
        self._sent &= layers

    def put(self, update: Update) -> None:
        """Add an update to those that wait."""
        with self._changed:
            waiting = self._pending
            if waiting is not None and not update.restarted:
                update = msgspec.structs.replace(
                    waiting,
                    status=update.status,
                    events=[*waiting.events, *update.events],
                    frames=[*waiting.frames, *update.frames],
                    layers=waiting.layers | update.layers,
                )
            self._pending = update
            self._changed.notify()

    def take(self, timeout_s: float) -> Update | None:
        """Return what has happened since the last call; None if nothing happens before the timeout."""
        with self._changed:
            self._changed.wait_for(lambda: self._pending is not None, timeout_s)
            update, self._pending = self._pending, None
            return update


class LiveMission:
    """Runs a mission in a thread of its own."""

    def __init__(self, load: Callable[[int | None], Scenario], *, speed: float, playing: bool) -> None:
        """Args: load: returns the scenario, with another seed unless it is None.  speed: simulated over wall time.

        Raises: RobotTeamSimError: the scenario cannot be simulated.
        """
        self._load, self._speed, self._playing = load, speed, playing
        self._commands: queue.SimpleQueue[tuple[Command, Future[None]] | None] = queue.SimpleQueue()
        self._subscriptions: list[Subscription] = []
        self._viewers = 0
        self._lock = threading.Lock()
        self._was_watched = False
        self._error = ""
        self._begin(None)
        self._thread = threading.Thread(target=self._run, daemon=True, name="mission")

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def close(self) -> None:
        """End the thread."""
        self._commands.put(None)
        self._thread.join()

    def execute(self, command: AnyCommand) -> None:
        """Execute a command between two steps. Raises: RobotTeamSimError, ValueError: it is not possible."""
        done: Future[None] = Future()
        self._commands.put((command, done))
        done.result(timeout=30.0)

    def subscribe(self) -> Subscription:
        """Return the updates of a new viewer, the first of which contains the scene."""
        with self._lock:
            self._viewers += 1
            subscription = Subscription(self._viewers, self._first_update())
            self._subscriptions.append(subscription)
        self._commands.put((Watched(), Future()))
        return subscription

    def unsubscribe(self, subscription: Subscription) -> None:
        """End the updates of a viewer."""
        with self._lock:
            self._subscriptions.remove(subscription)

    def _begin(self, seed: int | None) -> None:
        scenario = self._load(seed)
        simulation = Simulation(scenario)
        scenario = simulation.scenario  # with the places of random victims
        simulation.mission.start()
        self._simulation, self._coverage = simulation, RadioCoverage(scenario)
        recording = Recording(scene_of(simulation.setup), f"{scenario.name}, seed {scenario.run.seed}")
        self._header = header(recording)
        self._events: list[ShownEvent] = []
        self._fallen: frozenset[str] = frozenset()
        self._record = simulation.step()
        self._frames = [self._frame_of(self._record)]
        """Those that were sent."""
        self._maps: dict[str, LayerMap] = {}
        self._hazards: HazardField | None = None
        self._note(self._record)
        self._sent_events, self._radio_s, self._voice_changes = len(self._events), -_RADIO_SIM_S, -1

    def _run(self) -> None:
        due_s = sent_s = time.perf_counter()
        while True:
            is_moving = self._playing and self._was_watched and self._record.mission.state != "ended"
            wait_s = max(due_s - time.perf_counter(), 0.0) if is_moving else None
            try:
                wanted = self._commands.get(timeout=wait_s) if wait_s != 0.0 else self._commands.get_nowait()
            except queue.Empty:
                try:
                    self._step()
                except Exception as error:  # a mistake of the user, which concerns all robots
                    self._playing, self._error = False, f"{type(error).__name__}: {error}"
                    self._send()
                    continue
                now_s = time.perf_counter()
                due_s = max(due_s + self._simulation.scenario.run.step_s / self._speed, now_s - 0.1)
                if now_s - sent_s >= _FRAME_WALL_S or self._record.mission.state == "ended":
                    self._send()
                    sent_s = now_s
                continue
            if wanted is None:
                return
            self._answer(*wanted)
            due_s = time.perf_counter()

    def _answer(self, command: Command, done: Future[None]) -> None:
        try:
            self._execute(command)
        except Exception as error:  # the mission continues after any wrong command
            done.set_exception(error)
            return
        self._send()
        done.set_result(None)

    def _execute(self, command: Command) -> None:
        simulation = self._simulation
        match command:
            case Watched():
                self._was_watched = True
            case Play():
                self._playing = True
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
            case SetLayers(viewer, layers):
                with self._lock:
                    for subscription in self._subscriptions:
                        if subscription.viewer == viewer:
                            subscription.show(frozenset(layers))
            case Restart(seed):
                self._begin(seed)
                with self._lock:
                    for subscription in self._subscriptions:
                        subscription.send(self._first_update(), {}, ())

    def _step(self) -> None:
        if self._record.mission.state == "ended":
            return
        self._record = self._simulation.step()
        self._note(self._record)

    def _note(self, record: StepRecord) -> None:
        self._events += shown_events(record.events, record.sim_time_s)
        self._fallen |= fallen_of(record.events)
        if record.hazards is not None:
            self._hazards = record.hazards

    def _send(self) -> None:
        """Send the latest frame, and the events and maps that are new, to all viewers."""
        frame = self._frame_of(self._record)
        if frame.time_s == self._frames[-1].time_s:
            self._frames.pop()
        self._frames.append(msgspec.structs.replace(frame, scans_m=()))
        changed = self._update_maps()
        update = Update(self._status(), self._events[self._sent_events :], [frame], {})
        self._sent_events = len(self._events)
        with self._lock:
            for subscription in self._subscriptions:
                subscription.send(update, self._maps, changed)

    def _frame_of(self, record: StepRecord) -> Frame:
        """Return the frame of the last step, with what was changed by commands since then."""
        world, mission = self._simulation.world, self._simulation.mission
        frame = frame_of(record, world, with_scans="laser" in self._wanted())
        return msgspec.structs.replace(
            frame,
            doors=tuple(state.opening for state in world.door_states().values()),
            victims=victim_shapes(mission.victims, mission.status.victims, self._fallen, enclosed_of(record.people)),
            noise_db=mission.noise_db,
        )

    def _wanted(self) -> frozenset[str]:
        """Return the layers that any viewer shows."""
        with self._lock:
            return frozenset[str]().union(*(subscription.layers for subscription in self._subscriptions))

    def _update_maps(self) -> Collection[str]:
        """Compute the maps that somebody shows and that have changed; return their names."""
        wanted, maps = self._wanted(), dict[str, LayerMap]()
        time_s, voice = self._record.sim_time_s, self._simulation.hearing.sensor
        if "voice" in wanted and voice.version != self._voice_changes:
            self._voice_changes = voice.version
            maps["voice"] = layer_map(time_s, voice.map())
        if "radio" in wanted and time_s - self._radio_s >= _RADIO_SIM_S:
            self._radio_s = time_s
            coverage = self._coverage.at(self._frames[-1])
            maps |= {"radio": coverage[-1]} if coverage else {}
        hazards = self._hazards
        if hazards is not None and not wanted.isdisjoint(FIRST_LAYERS):
            self._hazards = None
            maps |= {"fire": fire_layer(time_s, hazards), "smoke": smoke_layer(time_s, hazards)}
        self._maps |= maps
        return maps.keys()

    def _status(self) -> dict[str, Any]:
        return {
            "playing": self._playing,
            "speed": self._speed,
            "seed": self._simulation.scenario.run.seed,
            "noise_db": self._simulation.mission.noise_db,
            "error": self._error,
        }

    def _first_update(self) -> Update:
        return Update(
            self._status(), self._events[: self._sent_events], list(self._frames), {}, restarted=True, **self._header
        )
