"""One mission in ROS, from its first step to its end. Independent of ROS."""

from collections.abc import Sequence

import numpy as np

from robotteamsim.hazards import HazardField
from robotteamsim.interface import Decision
from robotteamsim.mission import Mission
from robotteamsim.mission.status import Event
from robotteamsim.network.messages import Message, NetworkState
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.sensing.readings import RobotReading, VoiceReading
from robotteamsim.simulation import Observer, Result, StepRecord, Tally, true_positions_m
from robotteamsim.world.doors import DoorStates
from robotteamsim.world.people import PersonState


class Trial:
    """The mission, its totals, and the recorders that observe it; it has a `result` when it has ended."""

    def __init__(self, scenario: Scenario, recorders: Sequence[Observer]) -> None:
        """Start. Raises: RecordingError: a recorder cannot write."""
        self.mission = Mission(scenario)
        self.result: Result | None = None
        self._scenario = scenario
        self._tally: Tally | None = None
        self._steps = 0
        self._recorders: list[Observer] = []
        for recorder in recorders:
            recorder.begin(scenario)
            self._recorders.append(recorder)

    def step(
        self,
        sim_time_ns: int,
        readings: tuple[RobotReading, ...],
        voices: tuple[VoiceReading, ...],
        network: NetworkState,
        decisions: tuple[Decision, ...],
        doors: DoorStates | None = None,
        base_inbox: Sequence[Message] = (),
        present: np.ndarray | None = None,
        hazards: HazardField | None = None,
        failed: frozenset[int] = frozenset(),
        people: tuple[PersonState, ...] = (),
    ) -> tuple[Event, ...]:
        """Judge one step and return its events; totals do not change after the end.

        Args: doors: after the step; None if unknown.  base_inbox: messages that the base receives in it.
              present: whether each robot is present, bool, shape (n,); None if all are.
              hazards: in steps in which fire and smoke advance.  failed: absent robots that have failed by heat.
              people: that the world moves.
        """
        self.mission.follow_hazards(hazards, failed)
        if doors is not None:
            self.mission.follow_doors(doors)
        if people:
            self.mission.follow_people(people)
        positions_m = true_positions_m(readings)
        events = self.mission.step(sim_time_ns, positions_m, voices, network, decisions, base_inbox, present)
        if self.result is None:
            self._steps += 1
            self._record(
                StepRecord(
                    step_index=self._steps,
                    sim_time_ns=sim_time_ns,
                    readings=readings,
                    voices=voices,
                    network=network,
                    inboxes=tuple(() for _ in readings),
                    decisions=decisions,
                    mission=self.mission.status,
                    events=events,
                    victims=self.mission.victims,
                    noise_db=self.mission.noise_db,
                    voice_map=None,
                    present=present,
                    hazards=hazards,
                    failed=failed,
                    people=people,
                )
            )
        return events

    def _record(self, record: StepRecord) -> None:
        # Its wall clock starts here: nodes wait for each other before the first step.
        self._tally = self._tally or Tally(self._scenario)
        self._tally.add(record)
        for recorder in self._recorders:
            recorder.step(record)
        if record.mission.state == "ended":
            self.result = self._tally.result()
            while self._recorders:
                self._recorders[0].end(self.result)
                del self._recorders[0]

    def abandon(self) -> None:
        """End the recorders of an interrupted mission, unless it has ended."""
        while self._recorders:
            self._recorders.pop().abandon()
