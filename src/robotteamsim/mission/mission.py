"""The rules of a mission: areas explored, victims heard and saved, events, and its end [5.3]."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import msgspec

from robotteamsim import _core
from robotteamsim.hazards import HazardField
from robotteamsim.interface import Decision, Discovery, Task
from robotteamsim.mission import events
from robotteamsim.mission.area_order import AreaOrder
from robotteamsim.mission.base_station import BaseStation
from robotteamsim.mission.egress import Egress, EgressMonitor
from robotteamsim.mission.events import Event
from robotteamsim.mission.exits import Exits
from robotteamsim.mission.monitors import LinkMonitor, TeamMonitor, WorldMonitor
from robotteamsim.mission.rescue import Rescue
from robotteamsim.mission.sensed import Sensed
from robotteamsim.mission.status import IN_CARE, OUT_OF_DANGER, SAVED, MissionEnd, MissionState, MissionStatus
from robotteamsim.mission.victims import Casualties, VictimNews, Victims
from robotteamsim.network.messages import Message, Refusal, Traffic
from robotteamsim.scenario.base import Point
from robotteamsim.scenario.sections import Victim
from robotteamsim.setup import Setup


class Mission:
    """Judges one mission, step by step, only from what `step` is given; it has no access to the world.

    The mission's clock counts the steps while the mission is running, not those before the start, while paused or after
    the end. All events of a step have its time, see `StepRecord`. When a robot hears a voice, the victim who
    is the loudest at the loudest place near the robot counts as heard. If there is a base, `scenario.base`, a
    mission whose areas are all explored continues until all discoveries have been delivered to the base. If
    firefighters save the victims, `Rescue` judges them, and the mission ends when all of them are safe or dead; so does
    one without areas but with exits. Whoever is in an exit is safe. While somebody flees, the mission goes on.
    """

    def __init__(self, setup: Setup, speaker: Callable[[Point], str | None]) -> None:
        """Args: speaker: returns whose voice is the loudest at a place in `map` [m]; None if nobody calls."""
        scenario, self._speaker = setup.scenario, speaker
        self._areas, self._order = scenario.mission.areas, AreaOrder(scenario)
        self._save_distance_m = scenario.mission.save_distance_m
        self._time_limit_ns = round(scenario.mission.time_limit_s * 1e9)
        self._autostart = scenario.mission.autostart
        self._member = scenario.name_of
        self.noise_db = scenario.voice.noise_db
        """Background noise [dB]."""

        self._victims = Victims(scenario.mission.victims)
        self._rescue = Rescue(setup, speaker) if scenario.mission.saved_by == "firefighter" else None
        """None if robots save the victims."""
        self._exits, self._has_exits = Exits(scenario.mission.exits), bool(scenario.mission.exits)
        self._ends_in_safety = self._rescue is not None or (self._has_exits and not self._areas)
        self._has_team = scenario.team_size > 0
        self._casualties = None if scenario.fire is None else Casualties(scenario.fire)
        """None if nothing can burn."""
        self._egress = EgressMonitor(scenario) if scenario.has_egress else None
        self.places = self._all_places()
        """Those of victims whom robots save, then of areas, with the radius of each."""
        self._heard_places_m: set[Point] = set()
        """Loudest places that have been processed since the victims last changed."""

        self._world, self._links = WorldMonitor(scenario), LinkMonitor(scenario.team_size)
        base = () if scenario.base is None else (scenario.base,)
        self._team = TeamMonitor({*base, *scenario.firefighter_ids})
        self._refusals: set[Refusal] = set()
        self._base = BaseStation(scenario)

        self._state: MissionState = "waiting"
        self._end: MissionEnd = ""
        self._elapsed_ns = self._last_step_ns = 0
        self._team_was_running = False
        self._epoch = 0
        self._news: list[events.Happening] = []
        """What has happened since the last step."""
        self._is_task_new = False
        """Whether the task has changed in this step without an event."""
        self._quiet: tuple[Any, ...] | None = None
        """What was judged last, if nothing came of it; None: everything is judged in any case."""
        self.status = self._make_status()
        """The current status of the mission."""

    @property
    def victims(self) -> tuple[Victim, ...]:
        """The victims in the order of `status.victims`, at their current positions."""
        return self._victims.all

    @property
    def egress(self) -> Egress | None:
        """How people leave; None without fire and without exits."""
        return None if self._egress is None else self._egress.state

    @property
    def silent_victims(self) -> tuple[str, ...]:
        """Names of the victims who call no more."""
        return self._victims.silent

    def start(self) -> None:
        """Start a waiting mission; no effect in any other state."""
        if self._state == "waiting":
            self._state = "running"
            self._add(events.MissionStarted(len(self._areas), len(self.victims), self.noise_db))
            self.status = self._make_status()

    def pause(self) -> None:
        """Stop robots and clock of a running mission; no effect in any other state."""
        if self._state == "running":
            self._state = "paused"
            self._add(events.MissionPaused())
            self.status = self._make_status()

    def resume(self) -> None:
        """Resume a paused mission; no effect in any other state."""
        if self._state == "paused":
            self._state = "running"
            self._add(events.MissionResumed())
            self.status = self._make_status()

    def abort(self) -> None:
        """End the mission now, unless it has ended."""
        if self._state != "ended":
            self._finish("aborted")
            self.status = self._make_status()

    def set_noise_db(self, noise_db: float) -> None:
        """Record a new background noise, which changes the voice map."""
        self.noise_db = noise_db
        self._add(events.NoiseChanged(noise_db))
        self._change_task()

    def set_victim(self, name: str, position_m: Point) -> None:
        """Add a victim, or move an existing one; they then wait (again) to be heard and saved."""
        if self._casualties is not None:
            self._casualties.forget(name)
        if self._egress is not None:
            self._egress.place(name)
        self._base.forget("victim", name)
        index = self._victims.place(name, position_m)
        if self._rescue is not None:
            self._rescue.forget(index)
        self.places = self._all_places()
        self._heard_places_m.clear()
        self._add(events.VictimPlaced(name, position_m))
        self._change_task()

    def step(self, now: Sensed, decisions: Sequence[Decision]) -> tuple[Event, ...]:
        """Judge one step, in which the team decides this, and return the events since the last one, in order."""
        if self._team_was_running:
            self._elapsed_ns += now.sim_time_ns - self._last_step_ns
        self._last_step_ns = now.sim_time_ns
        if self._quiet is not None and self._is_quiet(now, decisions):
            self._judge_voices(now)  # robots that move hear new places all the time
            if not self._news:
                self.status = msgspec.structs.replace(self.status, time_s=self._elapsed_ns / 1e9)
                return ()
        for change in self._world.changes(now):
            self._add(change)
            if isinstance(change, events.DoorChanged):  # the voice map changes, and with it who is heard where
                self._epoch += 1
                self._heard_places_m.clear()
            if self._egress is not None and isinstance(change, events.FireStarted):
                self._egress.ignite(self._elapsed_ns / 1e9)
        if self._autostart and self._state == "waiting":
            self.start()
        # The task's epoch does not change when victims walk: bests must outlive a step of theirs.
        if now.moved and self._victims.move(now.moved):
            self.places = self._all_places()
            self._heard_places_m.clear()
        for change in self._world.departures_and_arrivals(now):
            self._add(change)
        if self._state == "running":
            self._judge(now, decisions)
        self._team_was_running = self._state == "running"
        is_quiet = not (self._news or self._is_task_new)
        may_rest = is_quiet and self._team_was_running and self._rescue is None
        self._quiet = self._judged(now, decisions) if may_rest else None
        if is_quiet:  # nothing but the time has changed
            self.status = msgspec.structs.replace(self.status, time_s=self._elapsed_ns / 1e9)
            return ()
        self._is_task_new = False
        self.status = self._make_status()
        news, self._news = self._news, []
        return tuple(Event(self._elapsed_ns / 1e9, what, what.words(self._member)) for what in news)

    @property
    def quiet_until_ns(self) -> int:
        """The stamp before which steps in which nothing happens need not be judged [ns]; 0: the next one must be."""
        if self._quiet is None or self._news or self._is_task_new:
            return 0
        return self._last_step_ns + self._time_limit_ns - self._elapsed_ns

    def pass_quietly(self, sim_time_ns: int) -> None:
        """Let steps pass in which nothing has happened, up to a stamp before `quiet_until_ns`."""
        self._elapsed_ns += sim_time_ns - self._last_step_ns
        self._last_step_ns = sim_time_ns
        self.status = msgspec.structs.replace(self.status, time_s=self._elapsed_ns / 1e9)

    def _is_quiet(self, now: Sensed, decisions: Sequence[Decision]) -> bool:
        """Whether nothing can come of a step but new voices: nothing came of the last one, and nothing has happened."""
        if self._news or self._is_task_new or now.moved or now.smoke_is_new or now.network.traffic.refused:
            return False
        if self._elapsed_ns >= self._time_limit_ns or self._base.undelivered:
            return False
        for decision in decisions:
            if decision.outbox:
                return False
        return self._judged(now, decisions) == self._quiet and not self.places.reached(now.state.positions_m)

    def _judged(self, now: Sensed, decisions: Sequence[Decision]) -> tuple[Any, ...]:
        """Return what is judged in a step, without what `_is_quiet` looks at itself."""
        statuses = [(decision.excluded, decision.swarm, decision.fault, decision.done) for decision in decisions]
        doors, people, levels = now.doors.version, now.people_version, self._world.level_of(now)
        return now.team_version, doors, now.network.version, now.ignited, now.burnt_doors, people, statuses, levels

    def _judge(self, now: Sensed, decisions: Sequence[Decision]) -> None:
        self._judge_voices(now)
        self._judge_places(now)
        passed = self._order.passed_over(decisions, now.present)
        if passed is not None:
            self._epoch += 1
            self._add(events.AreaPassedOver(passed.name))
        if self._rescue is not None:
            for news in self._rescue.judge(self._elapsed_ns / 1e9, now, decisions, self._victims):
                self._note_victim(news)
        for news in self._exits.left(self._victims):
            self._note_victim(news)
        if self._casualties is not None and now.hazards is not None:
            self._judge_harm(self._casualties, now.hazards)
        if self._base.undelivered:
            assert self._base.base is not None
            self._judge_deliveries(now.inboxes[self._base.base])
        for link in self._links.news(now.network):
            self._add(link)
        if now.network.traffic.refused:
            self._judge_messages(now.network.traffic)
        for change in self._team.changes(decisions, now.present):
            self._add(change)
        self._judge_end(now)

    def _judge_harm(self, casualties: Casualties, field: HazardField) -> None:
        harmed = casualties.judge(field, self._victims)
        if self._egress is not None:
            for lost in self._egress.expose(self._elapsed_ns / 1e9, field, self._victims, casualties):
                self._add(lost)
        for index, state, event in harmed:
            self._victims.collapse(event.victim)
            if self._rescue is not None:
                self._rescue.harm(index, state)
            # Those whom a firefighter has reached stay in their care until they die.
            in_care = self._victims.states[index] in IN_CARE
            if not (in_care and state == "collapsed"):
                self._victims.change(index, state)
            self._heard_places_m.clear()
            self._epoch += 1  # the voice leaves the map
            self._add(event)

    def _judge_voices(self, now: Sensed) -> None:
        if "waiting" not in self._victims.states:
            return
        for robot_id, voice in enumerate(now.voices):
            if voice.heard and voice.local_best_m not in self._heard_places_m:
                self._heard_places_m.add(voice.local_best_m)
                self._hear(robot_id, self._speaker(voice.local_best_m), voice.local_best_level_db)

    def _judge_places(self, now: Sensed) -> None:
        num_victims = len(self._saved_on_reach)
        areas = self._order.can_be_explored
        for place, robot_id in self.places.reached(now.state.positions_m):
            if place - num_victims in areas:
                self._explore(place - num_victims, robot_id)
            elif place < num_victims and self._needs_robot(place, now):
                self._save(place, robot_id)

    def _needs_robot(self, index: int, now: Sensed) -> bool:
        """Whether a robot saves a victim by reaching them: not those who flee, unless they are enclosed or collapse."""
        return self._victims.states[index] not in OUT_OF_DANGER and self._victims.needs_help(index, now.enclosed)

    def _save(self, index: int, robot_id: int) -> None:
        victim = self.victims[index]
        self._victims.change(index, "saved")
        self._heard_places_m.clear()
        self._epoch += 1  # the voice leaves the map
        count = self._victims.states.count("saved")
        self._add(events.VictimSaved(victim.name, count, len(self.victims), robot_id=robot_id))
        self._base.add(Discovery("victim", victim.name, robot_id, victim.position, self._elapsed_ns / 1e9))

    def _hear(self, robot_id: int, speaker: str | None, level_db: float) -> None:
        index = None if speaker is None else self._victims.index(speaker)
        if index is not None and self._victims.states[index] == "waiting":
            self._victims.change(index, "heard")
            self._add(events.VictimHeard(self.victims[index].name, level_db, robot_id=robot_id))

    def _explore(self, index: int, robot_id: int) -> None:
        area = self._order.explore(index, robot_id)
        self._epoch += not self._order.explored_by  # robots that choose their areas have another target later
        self._add(events.AreaExplored(area.name, self._order.num_explored, len(self._areas), robot_id=robot_id))
        self._base.add(Discovery("area", area.name, robot_id, area.center, self._elapsed_ns / 1e9))

    def _note_victim(self, news: VictimNews) -> None:
        """Record what has happened to a victim."""
        victim, time_s = self.victims[news.index], self._elapsed_ns / 1e9
        if news.event is not None:
            self._add(news.event)
        if self._egress is not None and isinstance(news.event, events.VictimSafe):
            self._egress.leave(victim.name, time_s, news.event.exit)
        if news.found is not None:
            self._base.add(Discovery("victim", victim.name, *news.found, time_s))
            self._is_task_new = True
        if news.state is not None and self._victims.change(news.index, news.state):
            self._heard_places_m.clear()
            self._epoch += 1  # the voice map changes

    def _judge_deliveries(self, base_inbox: Sequence[Message]) -> None:
        time_s = self._elapsed_ns / 1e9
        for found, is_first in self._base.deliver(base_inbox, time_s):
            self._is_task_new = True
            if is_first:
                self._add(events.DiscoveryDelivered(found.name, time_s - found.time_s, robot_id=found.robot_id))
            self._note_report(found)

    def _note_report(self, found: Discovery) -> None:
        """Record that the command centre knows where a victim is."""
        index = self._victims.index(found.name) if found.kind == "victim" else None
        if self._rescue is not None and index is not None and self._victims.states[index] == "located":
            self._victims.change(index, "reported")
            self._add(events.VictimReported(found.name, robot_id=found.robot_id))

    def _judge_messages(self, traffic: Traffic) -> None:
        for refusal in traffic.refused:
            if refusal not in self._refusals:
                self._refusals.add(refusal)
                self._add(events.MessageTooLarge(refusal.num_bytes, refusal.limit_bytes, robot_id=refusal.sender))

    def _judge_end(self, now: Sensed) -> None:
        somebody_flees = self._has_exits and self._victims.somebody_flees(now.enclosed)
        goes_on = self._rescue is not None or somebody_flees
        if self._ends_in_safety and self.victims and all(s in OUT_OF_DANGER for s in self._victims.states):
            self._finish("victims_safe")
        elif self._areas and self._order.num_explored == len(self._areas) and not (goes_on or self._base.undelivered):
            self._finish("areas_explored")
        elif self._elapsed_ns >= self._time_limit_ns:
            self._finish("time_limit")
        elif self._world.is_empty and self._has_team and not somebody_flees:
            self._finish("none_left")
        elif goes_on:
            return  # firefighters and people go on without robots
        elif self._team.all_excluded:
            self._finish("all_excluded")
        elif self._team.done and not self._base.undelivered:
            self._finish("search_over", self._team.done)

    def _finish(self, end: MissionEnd, why: str = "") -> None:
        self._state, self._end = "ended", end
        saved = sum(state in SAVED for state in self._victims.states)
        self._add(events.MissionEnded(end, self._order.num_explored, len(self._areas), saved, len(self.victims), why))

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

    def _add(self, what: events.Happening) -> None:
        self._news.append(what)

    def _make_status(self) -> MissionStatus:
        return MissionStatus(
            state=self._state,
            end=self._end,
            time_s=self._elapsed_ns / 1e9,
            explored=self._order.explored,
            victims=tuple(self._victims.states),
            target_area=self._order.target,
            endangered_links=self._links.num_endangered,
            task=self._make_task(),
            delivered=self._base.delivered,
        )

    def _make_task(self) -> Task:
        """Return the task of the team."""
        area = self._order.area
        return Task(
            running=self._state == "running",
            epoch=self._epoch,
            area_center_m=area.center if area else None,
            area_radius_m=area.radius_m if area else 0.0,
            undelivered=self._base.undelivered,
            assistance=() if self._rescue is None else self._rescue.assistance,
            explored_by=self._order.explored_by,
        )
