"""Records the frames of a mission while it runs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import msgspec

from robotteamsim.errors import RecordingError
from robotteamsim.propagation import RadioField
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.setup import Setup
from robotteamsim.simulation import Observer, Result, Simulation, StepRecord
from robotteamsim.view.found import FoundLayers
from robotteamsim.view.frame import Frame, ShownEvent, fallen_of, frame_of, sensor_texts, shown_events
from robotteamsim.view.layers import (
    LOWEST_DBM,
    MAX_CELLS,
    SMOKE_S,
    Film,
    LayerMap,
    field_layer,
    hazard_layers,
    keep_map,
)
from robotteamsim.view.scene import Scene, scene_of

FRAME_S = 0.2
"""Time between frames; the viewer interpolates [s]."""

SCAN_S = 1.0
"""Time between frames with scans [s]."""

MOST_SCANNED = 8
"""Scans of larger teams would make files too large."""

RADIO_S = 10.0
"""Time between maps of the team's radio coverage [s]."""

FOUND = "found_"
"""Names of maps that robots have found begin with this."""

_RADIO_CELL_M = 0.5


@dataclass(slots=True)
class Recording:
    """Everything that a viewer shows of one mission; a layer that is unknown has no maps.

    found: the map that each robot has found, by the name of its layer, see `found_name`.
    """

    scene: Scene
    title: str
    frames: list[Frame] = field(default_factory=list)
    events: list[ShownEvent] = field(default_factory=list)
    voice: list[LayerMap] = field(default_factory=list)
    radio: list[LayerMap] = field(default_factory=list)
    fire: list[LayerMap] = field(default_factory=list)
    smoke: list[LayerMap] = field(default_factory=list)
    found: dict[str, Film] = field(default_factory=dict)

    def add_found(self, index: int, layer: LayerMap | None) -> None:
        """Add a map of a robot of the scene, unless it is None."""
        if layer is not None:
            self.found.setdefault(found_name(index), Film()).add(layer)


def found_name(index: int) -> str:
    """Return the name of the map that a robot has found. Args: index: of the robot in the scene."""
    return f"{FOUND}{index}"


class FrameRecorder(Observer):
    """An observer that keeps the frames of a mission in `recording`."""

    def __init__(self, setup: Setup) -> None:
        scenario = setup.scenario
        self.coverage = RadioCoverage(scenario)
        self._setup = setup
        self._sensed: list[dict[str, Any]] = [{} for _ in setup.robots]
        self.sensors: tuple[dict[str, str], ...] = ()
        """As in the last frame that has them."""
        self._every = max(round(FRAME_S / scenario.run.step_s), 1)
        self._every_scan = max(round(SCAN_S / scenario.run.step_s / self._every), 1) * self._every
        self._every_radio = max(round(RADIO_S / scenario.run.step_s / self._every), 1) * self._every
        self._fallen: frozenset[str] = frozenset()
        self._has_scans = scenario.num_robots <= MOST_SCANNED
        title = f"{scenario.name}, seed {scenario.run.seed}, {scenario.voice.noise_db:g} dB"
        self.recording = Recording(scene_of(setup), title)
        self.found_layers = FoundLayers(setup.plan) if scenario.control.map == "unknown" else None

    def step(self, record: StepRecord) -> None:
        """Keep the frame of a step, if one is due, and its events."""
        found, index = self.recording, record.step_index - 1
        found.events += shown_events(record.events, record.mission.time_s)
        if record.voice_map is not None:
            found.voice.append(field_layer(record.mission.time_s, record.voice_map, 0.0))
        if record.hazards is not None:
            maps = hazard_layers(record.mission.time_s, record.hazards)
            keep_map(found.fire, maps["fire"])
            keep_map(found.smoke, maps["smoke"], SMOKE_S)
        for robot_id, layer in self.new_found(record):
            found.add_found(robot_id, layer)
        self._fallen |= fallen_of(record.events)
        for robot_id, readings in record.state.sensors.items():
            self._sensed[robot_id] |= readings
        if index % self._every and record.mission.state != "ended":
            return
        with_scans = self._has_scans and index % self._every_scan == 0
        frame = frame_of(record, self._setup, with_scans=with_scans, fallen=self._fallen)
        if with_scans:
            self.sensors = self._texts(record)
            frame = msgspec.structs.replace(frame, sensors=self.sensors)
        found.frames.append(frame)
        if index % self._every_radio == 0:
            found.radio += self.coverage.at(frame)

    def new_found(self, record: StepRecord) -> Iterator[tuple[int, LayerMap | None]]:
        """Yield the maps that robots show in a step, by their ids."""
        for robot_id, decision in enumerate(record.decisions):
            if decision.found is not None and self.found_layers is not None:
                yield robot_id, self.found_layers.layer(record.mission.time_s, decision.found)

    def _texts(self, record: StepRecord) -> tuple[dict[str, str], ...]:
        """Return the last readings of each robot's sensors in words. Raises: SensorError."""
        for robot_id, is_there in enumerate(record.present.tolist()):
            if not is_there:
                self._sensed[robot_id].clear()
        team = enumerate(zip(self._setup.robots, self._sensed, strict=True))
        texts = tuple(sensor_texts(robot_id, robot.sensors, readings) for robot_id, (robot, readings) in team)
        return texts if any(texts) else ()


class RadioCoverage:
    """The best signal of the team over the floor, through the doors as they are."""

    def __init__(self, scenario: Scenario) -> None:
        self._field = RadioField(scenario.plan, scenario.radio)
        self._doors = [door.name for door in scenario.plan.doors]
        (x0, y0), (x1, y1) = scenario.plan.bounds.min, scenario.plan.bounds.max
        self._cell_m = max(_RADIO_CELL_M, ((x1 - x0) * (y1 - y0) / MAX_CELLS) ** 0.5)

    def at(self, frame: Frame) -> list[LayerMap]:
        """Return the map at a frame; [] where no robot is present."""
        for name, opening in zip(self._doors, frame.doors, strict=False):
            self._field.set_door(name, opening == 0.0)
        places = [pose[:2] for pose in frame.poses if pose is not None]
        if not places:
            return []
        return [field_layer(frame.time_s, self._field.best_rssi_map_dbm(places, self._cell_m), LOWEST_DBM)]


def record_mission(scenario: Scenario) -> tuple[Recording, Result]:
    """Simulate a mission; return its recording and its result."""
    simulation = Simulation(scenario)
    recorder = FrameRecorder(simulation.setup)
    return recorder.recording, simulation.run([recorder])


def repeat_mission(scenario: Scenario, trajectory_hash: str, place: str) -> Recording:
    """Simulate a mission again and return its recording.

    Args:   trajectory_hash: of the first time. place: where it is stored, for the error.
    Raises: RecordingError: the trajectories differ.
    """
    recording, result = record_mission(scenario)
    if result.trajectory_hash != trajectory_hash:
        raise RecordingError(
            f"{place}: this version computes another mission (trajectory hash {result.trajectory_hash[:8]}.. instead "
            f"of {trajectory_hash[:8]}..), so it cannot be shown; a bag of it can"
        )
    return recording
