"""The media between robots: voices, radio and the messages that travel over it."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from robotteamsim.network import Network
from robotteamsim.network.messages import Message, NetworkState
from robotteamsim.propagation import FieldMap, RadioField
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.schedule import Upcoming
from robotteamsim.sensing.readings import NOTHING_HEARD, VoiceReading
from robotteamsim.sensing.voice import VoiceSensor
from robotteamsim.world.doors import DoorStates
from robotteamsim.world.people import PersonState
from robotteamsim.world.walking import Walkers


class Environment:
    """Voice and radio of one trial. The headless loop and the ROS environment node step this same class."""

    def __init__(self, scenario: Scenario) -> None:
        self._radio = RadioField(scenario.plan, scenario.radio)
        self.voice = VoiceSensor(scenario.plan, scenario.voice, scenario.mission.victims, scenario.run.seed)
        """The sensor of voices."""
        num_robots, run = scenario.team_size, scenario.run
        self._network = Network(self._radio, scenario.network, num_robots, seed=run.seed, step_ns=run.step_ns)
        self._doors = DoorStates.at_start(scenario.plan)
        self._step_ns = run.step_ns
        self._upcoming = Upcoming(scenario.schedule, ("noise_db", "victim"))
        self._walkers = Walkers(scenario)
        self._people: tuple[PersonState, ...] = ()

    def voice_map(self) -> FieldMap:
        """Return the voice level over the floor [dB]; 0 where no voice is above the noise."""
        return self.voice.map()

    def radio_map(self, position_m: tuple[float, float], resolution_m: float) -> FieldMap:
        """Return the signal of a robot at a position in `map` [m] over the floor [dBm]."""
        return self._radio.rssi_map_dbm(position_m, resolution_m)

    def advance_to(self, sim_time_ns: int) -> None:
        """Apply what the schedule changes before the step with this stamp [ns], and move the victims who walk."""
        for event in self._upcoming.due(sim_time_ns - self._step_ns):
            if event.noise_db is not None:
                self.set_noise_db(event.noise_db)
            elif event.victim is not None and event.position is not None:
                self.set_victim(event.victim, event.position)
        for name, position_m in self._walkers.positions_due(sim_time_ns).items():
            self.voice.move_victim(name, position_m)

    def follow_people(self, people: tuple[PersonState, ...]) -> None:
        """Move the voices of the people of the world; the same tuple as before means that nobody has moved."""
        if people is self._people:
            return
        self._people = people
        known = set(self.voice.victim_names())
        for person in people:
            if person.name in known:
                self.voice.move_victim(person.name, person.position_m)

    def victim_names(self) -> tuple[str, ...]:
        """Return the names of the victims in the order in which they were added, as in the mission."""
        return self.voice.victim_names()

    def step(
        self,
        positions_m: np.ndarray,
        outboxes: Sequence[Sequence[Message]],
        saved: Collection[str],
        present: np.ndarray | None = None,
    ) -> tuple[tuple[VoiceReading, ...], NetworkState, Sequence[Sequence[Message]]]:
        """Return the voices that the robots hear, the links of this step, and the messages that arrive.

        Args:
            positions_m: true positions in `map`, shape (n, 2) [m].
            outboxes:    messages sent in the last step, one sequence per robot in id order.
            saved:       names of the victims who are silent as of the last step.
            present:     whether each robot is present, bool, shape (n,); None: all are. Absent robots hear nothing.
        Returns: voice readings in id order, the network, and the inbox of each robot in id order.
        """
        self.voice.set_silenced(saved)
        network, inboxes = self._network.step(positions_m, outboxes, present)
        if present is None:
            return self.voice.read_team(positions_m), network, inboxes
        heard = iter(self.voice.read_team(positions_m[present]))
        voices = tuple(next(heard) if is_there else NOTHING_HEARD for is_there in present.tolist())
        return voices, network, inboxes

    def set_door(self, name: str, closed: bool) -> None:
        """Open or close a door for radio and voices. Raises: ValueError: no such door."""
        self._radio.set_door(name, closed)
        self.voice.set_door(name, closed)
        self._doors = self._doors.with_door(name, closed)

    def follow_doors(self, doors: DoorStates) -> None:
        """Open and close for radio and voices the doors that the world has opened and closed."""
        for name, before, now in doors.changes_since(self._doors):
            if now.closed != before.closed:
                self.set_door(name, now.closed)
        self._doors = doors

    def set_noise_db(self, noise_db: float) -> None:
        """Set the background noise [dB]; voices below it are not heard."""
        self.voice.set_noise_db(noise_db)

    def set_victim(self, name: str, position_m: tuple[float, float]) -> None:
        """Add a victim, or move the one of that name [m, map]; they call (again), and no longer walk."""
        self._walkers.stop(name)
        self.voice.set_victim(name, position_m)
