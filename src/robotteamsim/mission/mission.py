"""The rules of a mission: areas explored in order, victims heard and saved, events, and its end [5.3]."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import repeat

import msgspec
import numpy as np

from robotteamsim import _core
from robotteamsim.hazards import HazardField
from robotteamsim.interface import Decision, Discovery, Task
from robotteamsim.mission.base_station import BaseStation
from robotteamsim.mission.casualties import Casualties
from robotteamsim.mission.link_monitor import LinkMonitor
from robotteamsim.mission.rescue import NOBODY, Rescue, VictimNews
from robotteamsim.mission.status import (
    END_TEXTS,
    OUT_OF_DANGER,
    SAVED,
    SILENT,
    Event,
    MissionEnd,
    MissionState,
    MissionStatus,
    VictimState,
)
from robotteamsim.mission.team_monitor import TeamMonitor
from robotteamsim.mission.team_news import TeamNews
from robotteamsim.network.messages import Message, NetworkState, Refusal, Traffic
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.schedule import Upcoming
from robotteamsim.scenario.sections import Victim
from robotteamsim.sensing.readings import VoiceReading
from robotteamsim.wording import counted
from robotteamsim.world.contract import Mishap
from robotteamsim.world.doors import DoorStates, LeafMotion
from robotteamsim.world.people import PersonState
from robotteamsim.world.walking import Walkers

_MOTION: dict[LeafMotion, str] = {"still": "stops", "opens": "opens", "closes": "closes", "held": "is blocked"}


class Mission:
    """Judges one mission, step by step, only from the arguments of `step`; it has no access to the world.

    The mission's clock counts the steps while the mission is running, not those before the start, while paused or after
    the end. When a robot hears a voice, the unsaved victim nearest to the loudest place that the robot perceives counts
    as heard. If there is a base, `scenario.base`, a mission whose areas are all explored continues until all
    discoveries have been delivered to the base. If firefighters save the victims, `Rescue` judges them, and the mission
    ends when all of them are safe or dead.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._areas = scenario.mission.areas
        self.victims = scenario.mission.victims
        """The victims in the order of `status.victims`, at their current positions."""
        self._save_distance_m = scenario.mission.save_distance_m
        self._time_limit_ns = round(scenario.mission.time_limit_s * 1e9)
        self._autostart = scenario.mission.autostart
        self.noise_db = scenario.voice.noise_db
        """Background noise [dB]."""

        self._doors = DoorStates.at_start(scenario.plan)
        self._step_ns = scenario.run.step_ns
        self._upcoming = Upcoming(scenario.schedule, ("noise_db", "victim"))
        self._walkers = Walkers(scenario)
        self._casualties = None if scenario.fire is None else Casualties(scenario.fire)
        """None if nothing can burn."""
        self.failed: frozenset[int] = frozenset()
        """Ids of the absent robots that have failed by heat, and of firefighters who have collapsed."""
        self._member, self._role = scenario.name_of, scenario.role_of
        self._rescue = Rescue(scenario) if scenario.mission.saved_by == "firefighter" else None
        """None if robots save the victims."""
        self._people: tuple[PersonState, ...] = ()

        self._state: MissionState = "waiting"
        self._end: MissionEnd = ""
        self._elapsed_ns = self._last_step_ns = 0
        self._team_was_running = False
        self._num_explored = self._epoch = 0
        self._victim_states: list[VictimState] = ["waiting"] * len(self.victims)
        self._note_who_calls()
        self._places = self._all_places()
        self._heard_places_m: set[tuple[float, float]] = set()
        """Loudest places that have been processed since the victims last changed."""
        self._links = LinkMonitor()
        base = () if scenario.base is None else (scenario.base,)
        self._team = TeamMonitor({*base, *scenario.firefighter_ids})
        present = np.array(scenario.present_at_start, dtype=bool)
        self._num_robots = len(present)
        self._present = None if present.all() else present
        """Whether each robot was present in the last step; None if all were."""
        self._base = BaseStation(scenario)
        self._refusals: set[Refusal] = set()
        self._news = TeamNews()
        self._events: list[Event] = []
        self._is_task_new = False
        """Whether the task has changed in this step without an event."""
        self.task = Task()
        """The current task of the team."""
        self.status = self._make_status()
        """The current status of the mission."""

    def start(self) -> None:
        """Start a waiting mission; no effect in any other state."""
        if self._state == "waiting":
            self._state = "running"
            areas, victims = counted(len(self._areas), "area"), counted(len(self.victims), "victim")
            detail = f"{areas}, {victims}, {self.noise_db:g} dB noise"
            self._add_event("start", "", NOBODY, f"mission starts: {detail}")
            self.status = self._make_status()

    def pause(self) -> None:
        """Stop robots and clock of a running mission; no effect in any other state."""
        if self._state == "running":
            self._state = "paused"
            self._add_event("pause", "", NOBODY, "mission is paused")
            self.status = self._make_status()

    def resume(self) -> None:
        """Resume a paused mission; no effect in any other state."""
        if self._state == "paused":
            self._state = "running"
            self._add_event("resume", "", NOBODY, "mission is resumed")
            self.status = self._make_status()

    def abort(self) -> None:
        """End the mission now, unless it has ended."""
        if self._state != "ended":
            self._finish("aborted")
            self.status = self._make_status()

    def note(self, kind: str, subject: str, detail: str) -> None:
        """Add an event from outside the mission."""
        self._add_event(kind, subject, NOBODY, detail)

    def set_door(self, name: str, closed: bool) -> None:
        """Record that a door was opened or closed, which changes the voice map."""
        self._add_event("door", name, NOBODY, f"door {name} is {'closed' if closed else 'opened'}")
        self._change_task()

    def follow_doors(self, doors: DoorStates) -> None:
        """Record the current states of the world's doors; opening or closing one changes the voice map."""
        for name, before, now in doors.changes_since(self._doors):
            if now.closed != before.closed:
                self.set_door(name, now.closed)
            elif now.motion != before.motion:
                detail = f"door {name} {_MOTION[now.motion]}, {now.opening:.0%} open"
                self._add_event("door_moves", name, NOBODY, detail)
        self._doors = doors
        if self._rescue is not None:
            self._rescue.follow_doors(doors)

    def follow_people(self, people: tuple[PersonState, ...]) -> None:
        """Record where the people of the world are; the same tuple as before means that nobody has moved."""
        if people is self._people:
            return
        self._people = people
        self._move_victims({person.name: person.position_m for person in people})
        if self._rescue is not None:
            for name in self._rescue.follow_people(people):
                self._add_event("person_enclosed", name, NOBODY, f"{name} waits, because no path to an exit is open")

    def follow_team(self, mishaps: Mapping[int, Mishap], loads: Mapping[int, str]) -> None:
        """Record which robots cannot go on and why, and what robots hold, by id."""
        for news in self._news.of(mishaps, loads):
            self._add_event(*news)

    def follow_hazards(self, field: HazardField | None, failed: frozenset[int]) -> None:
        """Record fire and smoke of the step to be judged, and the absent members who have failed or collapsed.

        Args: field: None if fire and smoke have not advanced in this step.
        """
        if self._casualties is not None:
            self._casualties.follow(field)
        if self._rescue is not None and field is not None:
            self._rescue.follow_smoke(field)
        self.failed = failed

    def set_noise_db(self, noise_db: float) -> None:
        """Record a new background noise, which changes the voice map."""
        self.noise_db = noise_db
        self._add_event("noise", "", NOBODY, f"background noise is {noise_db:g} dB")
        self._change_task()

    def set_victim(self, name: str, position_m: tuple[float, float]) -> None:
        """Add a victim, or move an existing one, who no longer walks; they then wait (again) to be heard and saved."""
        self._walkers.stop(name)
        if self._casualties is not None:
            self._casualties.forget(name)
        victim = Victim(name=name, position=position_m)
        names = [known.name for known in self.victims]
        index = names.index(name) if name in names else len(names)
        self.victims = (*self.victims[:index], victim, *self.victims[index + 1 :])
        self._victim_states[index : index + 1] = ["waiting"]
        if self._rescue is not None:
            self._rescue.forget(index, name)
        self._note_who_calls()
        self._places = self._all_places()
        self._heard_places_m.clear()
        self._add_event("victim", name, NOBODY, f"victim {name} calls at ({position_m[0]:.1f}, {position_m[1]:.1f})")
        self._change_task()

    def step(
        self,
        sim_time_ns: int,
        positions_m: np.ndarray,
        voices: Sequence[VoiceReading],
        network: NetworkState,
        decisions: Sequence[Decision],
        base_inbox: Sequence[Message] = (),
        present: np.ndarray | None = None,
    ) -> tuple[Event, ...]:
        """Judge one step of the world and return the events since the last one, in order.

        Args:
            sim_time_ns: stamp of the step [ns].
            positions_m: true positions of the robots in `map`, shape (n, 2) [m].
            voices, decisions: one per robot, in id order.
            base_inbox: messages that the base receives in this step, if there is a base.
            present:    whether each robot is present, bool, shape (n,); None if all are. Absent robots do not count.
        """
        if self._autostart and self._state == "waiting":
            self.start()
        self._follow_schedule(sim_time_ns - self._step_ns)
        self._walk(sim_time_ns)
        if self._team_was_running:
            self._elapsed_ns += sim_time_ns - self._last_step_ns
        self._last_step_ns = sim_time_ns
        if present is not self._present:
            self._judge_presence(present)
        if self._state == "running":
            self._judge_victims_and_areas(positions_m, voices, present)
            if self._base.undelivered:
                self._judge_deliveries(base_inbox)
            for link, detail in self._links.news(network):
                self._add_event("link_endangered", link, NOBODY, detail)
            if network.traffic.refused:
                self._judge_messages(network.traffic)
            for change in self._team.changes(decisions, present):
                self._add_event(change.kind, change.subject, change.robot_id, change.detail)
            self._judge_end()
        self._team_was_running = self._state == "running"
        if not (self._events or self._is_task_new):  # nothing but the time has changed
            self.status = msgspec.structs.replace(self.status, time_s=self._elapsed_ns / 1e9)
            return ()
        self._is_task_new = False
        self.status = self._make_status()
        events, self._events = tuple(self._events), []
        return events

    def _judge_victims_and_areas(
        self, positions_m: np.ndarray, voices: Sequence[VoiceReading], present: np.ndarray | None
    ) -> None:
        self._judge_voices(voices)
        self._judge_places(positions_m)
        if self._rescue is not None:
            self._judge_rescue(self._rescue, positions_m, voices, present)
        if self._casualties is not None:
            self._judge_harm(self._casualties)

    def _follow_schedule(self, begin_ns: int) -> None:
        """Change noise and victims as the schedule says for a step that begins at this time [ns]."""
        for event in self._upcoming.due(begin_ns):
            if event.noise_db is not None:
                self.set_noise_db(event.noise_db)
            elif event.victim is not None and event.position is not None:
                self.set_victim(event.victim, event.position)

    def _walk(self, sim_time_ns: int) -> None:
        due = self._walkers.positions_due(sim_time_ns)
        if due:
            self._move_victims(due)

    def _move_victims(self, places: Mapping[str, tuple[float, float]]) -> None:
        """Move the unsaved victims who walk. The task's epoch does not change: bests must outlive a step of theirs."""
        moved = tuple(
            victim
            if state in OUT_OF_DANGER or places.get(victim.name, victim.position) == victim.position
            else victim.model_copy(update={"position": places[victim.name]})
            for victim, state in zip(self.victims, self._victim_states, strict=True)
        )
        if moved != self.victims:
            self.victims = moved
            self._note_who_calls()
            self._places = self._all_places()
            self._heard_places_m.clear()

    def _judge_harm(self, casualties: Casualties) -> None:
        for index, state, dose in casualties.judge(self.victims, self._victim_states):
            name = self.victims[index].name
            self._harm(index, state)
            self._note_who_calls()
            self._heard_places_m.clear()
            self._epoch += 1  # the voice leaves the map
            does = "dies" if state == "dead" else "collapses"
            self._add_event(f"victim_{state}", name, NOBODY, f"{name} {does}: {dose}")

    def _harm(self, index: int, state: VictimState) -> None:
        """Let a victim collapse or die; those whom a firefighter has reached stay in their care until they die."""
        if self._rescue is not None:
            self._rescue.harm(index, self.victims[index].name, state)
            if state == "collapsed" and self._victim_states[index] in ("reached", "carried"):
                return
        self._victim_states[index] = state

    def _judge_voices(self, voices: Sequence[VoiceReading]) -> None:
        if "waiting" not in self._victim_states:
            return
        for robot_id, voice in enumerate(voices):
            if voice.heard and voice.local_best_m not in self._heard_places_m:
                self._heard_places_m.add(voice.local_best_m)
                self._hear(robot_id, voice.local_best_m, voice.local_best_level_db)

    def _judge_places(self, positions_m: np.ndarray) -> None:
        num_victims = len(self._saved_on_reach)
        area = num_victims + self._num_explored
        for place, robot_id in self._places.reached(positions_m):
            if place == area:
                self._explore(robot_id)
            elif place < num_victims and self._victim_states[place] not in OUT_OF_DANGER:
                self._save(place, robot_id)

    def _save(self, index: int, robot_id: int) -> None:
        victim = self.victims[index]
        self._victim_states[index] = "saved"
        self._note_who_calls()
        self._heard_places_m.clear()
        self._epoch += 1  # the voice leaves the map
        count = f"{self._victim_states.count('saved')} of {len(self.victims)}"
        self._add_event("victim_saved", victim.name, robot_id, f"robot {robot_id} saves {victim.name} ({count})")
        self._base.add(Discovery("victim", victim.name, robot_id, victim.position, self._elapsed_ns / 1e9))

    def _note_who_calls(self) -> None:
        silent = [state in SILENT for state in self._victim_states]
        names = [victim.name for victim in self.victims]
        self.silent_victims = tuple([name for name, is_silent in zip(names, silent, strict=True) if is_silent])
        """Names of the victims who call no more; the same object until another victim falls silent."""
        states = zip(names, self._victim_states, strict=True)
        self.saved_victims = tuple([name for name, state in states if state in SAVED])
        """Names of the saved victims."""
        self._unsaved = [i for i, is_silent in enumerate(silent) if not is_silent and self.victims[i].calling]
        """Indices of the victims who may be heard."""
        self._unsaved_m = [self.victims[index].position for index in self._unsaved]

    def _hear(self, robot_id: int, loudest_m: tuple[float, float], level_db: float) -> None:
        if not self._unsaved:
            return  # the last voice of a victim who was saved in the step before
        distances_m = list(map(math.dist, self._unsaved_m, repeat(loudest_m)))
        index = self._unsaved[distances_m.index(min(distances_m))]
        if self._victim_states[index] == "waiting":
            self._victim_states[index] = "heard"
            name = self.victims[index].name
            self._add_event(
                "victim_heard", name, robot_id, f"{self._member(robot_id)} hears {name} at {level_db:.1f} dB"
            )

    def _explore(self, robot_id: int) -> None:
        area = self._areas[self._num_explored]
        self._num_explored += 1
        self._epoch += 1
        count = f"{self._num_explored} of {len(self._areas)}"
        self._add_event("area_explored", area.name, robot_id, f"robot {robot_id} explores {area.name} ({count})")
        self._base.add(Discovery("area", area.name, robot_id, area.center, self._elapsed_ns / 1e9))

    def _judge_rescue(
        self, rescue: Rescue, positions_m: np.ndarray, voices: Sequence[VoiceReading], present: np.ndarray | None
    ) -> None:
        time_s = self._elapsed_ns / 1e9
        for news in rescue.judge(time_s, positions_m, present, voices, self.victims, self._victim_states):
            self._note_victim(news)

    def _note_victim(self, news: VictimNews) -> None:
        """Record what has happened to a victim."""
        victim, time_s = self.victims[news.index], self._elapsed_ns / 1e9
        if news.detail:
            self._add_event(news.kind, victim.name, news.robot_id, news.detail)
        if news.position_m is not None:
            self._base.add(Discovery("victim", victim.name, news.robot_id, news.position_m, time_s))
            self._is_task_new = True
        if news.state is not None:
            was_silent = self._victim_states[news.index] in SILENT
            self._victim_states[news.index] = news.state
            if was_silent != (news.state in SILENT):
                self._note_who_calls()
                self._heard_places_m.clear()
                self._epoch += 1  # the voice map changes

    def _judge_deliveries(self, base_inbox: Sequence[Message]) -> None:
        time_s = self._elapsed_ns / 1e9
        for found in self._base.deliver(base_inbox, time_s):
            delay = f"{time_s - found.time_s:.1f} s after its discovery by robot {found.robot_id}"
            self._add_event(
                "discovery_delivered", found.name, found.robot_id, f"{found.name} is delivered to the base, {delay}"
            )
            self._note_report(found)

    def _note_report(self, found: Discovery) -> None:
        """Record that the command centre knows where a victim is."""
        names = [victim.name for victim in self.victims]
        index = names.index(found.name) if found.kind == "victim" and found.name in names else NOBODY
        if self._rescue is not None and index != NOBODY and self._victim_states[index] == "located":
            self._victim_states[index] = "reported"
            detail = f"the command centre knows where {found.name} is"
            self._add_event("victim_reported", found.name, found.robot_id, detail)

    def _judge_messages(self, traffic: Traffic) -> None:
        for refusal in traffic.refused:
            if refusal not in self._refusals:
                self._refusals.add(refusal)
                size = f"{refusal.num_bytes} bytes, the limit is {refusal.limit_bytes}"
                self._add_event("message_too_large", "", refusal.sender, f"robot {refusal.sender} cannot send {size}")

    def _judge_presence(self, present: np.ndarray | None) -> None:
        before, self._present = self._present, present
        now = np.ones(self._num_robots, dtype=bool) if present is None else present
        then = np.ones(self._num_robots, dtype=bool) if before is None else before
        for robot_id in np.flatnonzero(then & ~now).tolist():
            kind, does = self._why_gone(robot_id)
            self._add_event(kind, "", robot_id, f"{self._member(robot_id)} {does}")
        for robot_id in np.flatnonzero(now & ~then).tolist():
            self._add_event("robot_spawned", "", robot_id, f"{self._member(robot_id)} is spawned")

    def _why_gone(self, robot_id: int) -> tuple[str, str]:
        """Return the kind of event, and the verb, for a member who has left the world."""
        if robot_id not in self.failed:
            return "robot_removed", "is removed"
        is_firefighter = self._role(robot_id) == "firefighter"
        return ("firefighter_collapsed", "collapses") if is_firefighter else ("robot_failed_by_heat", "fails from heat")

    def _judge_end(self) -> None:
        if self._rescue is not None and self.victims and all(s in OUT_OF_DANGER for s in self._victim_states):
            self._finish("victims_safe")
        elif self._areas and self._num_explored == len(self._areas) and not (self._rescue or self._base.undelivered):
            self._finish("areas_explored")
        elif self._elapsed_ns >= self._time_limit_ns:
            self._finish("time_limit")
        elif self._present is not None and not self._present.any():
            self._finish("none_left")
        elif self._rescue is not None:
            return  # firefighters and people go on without robots
        elif self._team.all_excluded:
            self._finish("all_excluded")
        elif self._team.done and not self._base.undelivered:
            self._finish("search_over", f": {self._team.done}")

    def _finish(self, end: MissionEnd, why: str = "") -> None:
        self._state, self._end = "ended", end
        saved = sum(state in SAVED for state in self._victim_states)
        count = f"{self._num_explored}/{len(self._areas)} areas, {saved}/{len(self.victims)} victims"
        self._add_event("end", "", NOBODY, f"mission ends: {END_TEXTS[end]}{why}; {count}")

    def _all_places(self) -> _core.base.Places:
        """Return the positions of victims whom robots save, then of areas, with the radius of each."""
        places = [victim.position for victim in self._saved_on_reach] + [area.center for area in self._areas]
        reaches = [self._save_distance_m] * len(self._saved_on_reach) + [area.radius_m for area in self._areas]
        return _core.base.Places(places, reaches)

    @property
    def _saved_on_reach(self) -> tuple[Victim, ...]:
        """The victims whom a robot saves by reaching them."""
        return self.victims if self._rescue is None else ()

    def _change_task(self) -> None:
        self._epoch += 1
        self.status = self._make_status()

    def _add_event(self, kind: str, subject: str, robot_id: int, detail: str) -> None:
        self._events.append(Event(self._elapsed_ns / 1e9, kind, subject, robot_id, detail))

    def _make_status(self) -> MissionStatus:
        num_left = len(self._areas) - self._num_explored
        return MissionStatus(
            state=self._state,
            end=self._end,
            time_s=self._elapsed_ns / 1e9,
            explored=(True,) * self._num_explored + (False,) * num_left,
            victims=tuple(self._victim_states),
            target_area=self._num_explored if num_left else -1,
            endangered_links=self._links.num_endangered,
            task=self._make_task(),
            delivered=self._base.delivered,
        )

    def _make_task(self) -> Task:
        """Return the task of the team, and store it."""
        area = self._areas[self._num_explored] if self._num_explored < len(self._areas) else None
        self.task = Task(
            running=self._state == "running",
            epoch=self._epoch,
            area_center_m=area.center if area else None,
            area_radius_m=area.radius_m if area else 0.0,
            undelivered=self._base.undelivered,
            assistance=() if self._rescue is None else self._rescue.assistance,
        )
        return self.task
