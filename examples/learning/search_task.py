"""What both trainings share: buildings, observations, actions, rewards, and how a policy is judged."""

from __future__ import annotations

import argparse
import csv
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch

from robotteamsim.arguments import positive_number, positive_whole_number
from robotteamsim.campaign.protocol import SearchProtocol, search_design
from robotteamsim.cli.parser import folder_of
from robotteamsim.control.driving.known_map import UNREACHABLE_M, known_map
from robotteamsim.learning import Act, BatchEnv, Observe, Percepts, Reward, Steps, export_policy, seen_from
from robotteamsim.scenario import Scenario
from robotteamsim.scenario.building import Building
from robotteamsim.scenario.sections import Team
from robotteamsim.setup import Setup, resolve
from robotteamsim.simulation import Simulation, StepRecord

Place = tuple[float, float]

TRAINING = ("garage", "isr_floor", "warehouse")
HELD_OUT = "office"
HELD_OUT_SEED = 1_000_000
"""Missions that judge a policy have seeds from here on; trainings have others."""


def search_scenario(building: str, controller: str = "random_walk") -> Scenario:
    """Return the mission of `robotteamsim benchmark search` in a building: 3 robots, 4 random victims, 20 dB."""
    protocol = SearchProtocol((controller,), (building,), (20.0,), (3,), trials=1)
    return search_design(protocol).cells[0].scenario


def training_scenarios() -> list[Scenario]:
    """Return the missions of the buildings for training, from random starts."""
    made = []
    for scenario in map(search_scenario, TRAINING):
        assert isinstance(scenario.robots, Team)
        made.append(scenario.model_copy(update={"robots": scenario.robots.model_copy(update={"formation": "random"})}))
    return made


def lengths_to(building: Building, reach_m: float, goal: Place) -> np.ndarray | None:
    """Return the path length to a goal from each cell of a robot's known map [m]; None if nothing is free there."""
    grid = known_map(building, reach_m).grid
    free = grid.nearest_free(goal, 5.0)
    return None if free is None else grid.distance_map(free)


class SearchObserve(Observe):
    """What a policy needs in any building: no place in `map`, all directions from the robot."""

    SECTORS, NEAR_M, FAR_M = 24, 4.0, 40.0

    def parts_of(self) -> list[tuple[str, int, str]]:
        """Return name, size and meaning of each part."""
        return [
            ("sectors", self.SECTORS, "shortest range in each sector of the laser / 4 m, from right to left"),
            ("twist", 2, "as in Observe"),
            ("loudness", 1, "of the loudest cell / 100 dB"),
            (
                "to_voice",
                4,
                "it is heard; cosine and sine of the path to the loudest cell, its length / 40 m",
            ),
            ("to_area", 4, "there is one; the same of the path to it"),
            ("teammate", 3, "the nearest heard of: heard of, x and y from the robot / 4 m"),
        ]

    def vectors(self, percepts: Percepts) -> np.ndarray:
        """Return the vector of each agent, shape (..., n, size of the space)."""
        whole = super().vectors(percepts)
        edges = np.linspace(0, self.beams, self.SECTORS, endpoint=False).astype(int)
        sectors = np.minimum.reduceat(percepts.ranges_m, edges, axis=-1) / self.NEAR_M
        twist, loudness = (whole[..., self.beams + i : self.beams + j] for i, j in ((4, 6), (7, 8)))
        parts = sectors, twist, loudness, *self._routes(percepts), self._nearest(percepts)
        return np.clip(np.concatenate(parts, -1, dtype=np.float32), -1.0, 1.0)

    def _routes(self, percepts: Percepts) -> list[np.ndarray]:
        """Return the numbers of the shortest paths on the known map to the loudest cell and to the area."""
        building, routes = self.setup.building, []
        goals = percepts.voices[..., (0, 2, 3)], np.broadcast_to(percepts.area, (*percepts.poses.shape[:-1], 3))
        for is_area, goal in enumerate(goals):
            ahead_m, numbers = percepts.poses[..., :2].copy(), np.zeros((*goal.shape[:-1], 4))
            for index in zip(*np.nonzero(goal[..., 0]), strict=True):
                reach_m = self.setup.robots[self.robot_ids[index[-1]]].reach_m
                grid = known_map(building, reach_m).grid
                place, position = tuple(goal[index][1:].tolist()), percepts.poses[index][:2].tolist()
                start = grid.nearest_free(position, 1.0)
                lengths_m = building.shared(lengths_to, reach_m, place) if is_area else None
                ahead, length_m = None, 0.0
                if start is not None and lengths_m is not None:
                    ahead, length_m = grid.descend(lengths_m, start, 3.0), grid.value_at(lengths_m, start)
                elif start is not None:
                    free = grid.nearest_free(place, 1.0)
                    ahead, length_m = grid.first_stretch(start, free or place, self.FAR_M)
                if ahead is not None:
                    ahead_m[index], numbers[index] = ahead, (1.0, 0.0, 0.0, length_m / self.FAR_M)
            offsets_m = seen_from(percepts.poses, ahead_m[..., None, :])[..., 0, :]
            numbers[..., 1:3] = offsets_m / np.maximum(np.hypot(*np.moveaxis(offsets_m, -1, 0)), 1e-9)[..., None]
            routes.append(numbers)
        return routes

    def _nearest(self, percepts: Percepts) -> np.ndarray:
        """Return the numbers of the nearest teammate, shape (..., n, 3)."""
        numbers = np.zeros((*percepts.poses.shape[:-1], 3))
        if self.teammates:
            sent_m = percepts.heard[..., 1:3] - percepts.poses[..., None, :2]
            offsets_m = np.where(percepts.heard[..., :1] > 0.0, sent_m, np.inf)
            nearest = np.hypot(offsets_m[..., 0], offsets_m[..., 1]).argmin(-1)[..., None, None]
            place_m = np.take_along_axis(percepts.heard[..., :3], nearest, -2)[..., 0, :]
            numbers[..., 0] = place_m[..., 0]
            seen_m = seen_from(percepts.poses, place_m[..., None, 1:])[..., 0, :]
            numbers[..., 1:] = seen_m / self.NEAR_M * place_m[..., :1]
        return numbers


class AheadAct(Act):
    """Speed and turn, where the speed is never backward: -1 stands, 1 is full speed."""

    def twists(self, actions: np.ndarray) -> np.ndarray:
        """Return the twists of actions."""
        ahead = actions.copy()
        ahead[..., 0] = 0.5 * (actions[..., 0] + 1.0)
        return super().twists(ahead)


class OwnProgress(Reward):
    """Areas and victims for all; progress, contacts and time for each robot.

    A robot that hears a voice makes progress towards the victim with the shortest path, any other towards the area. It
    has the places of victims, which its observation has not.
    """

    AREA, VICTIM, PER_CONTACT_S, PER_S = 0.5, 1.0, -0.2, -0.01
    PER_METRE, PER_METRE_TO_VOICE = 0.1, 0.2

    def __init__(self, setup: Setup, robot_ids: Sequence[int], missions: int = 1) -> None:
        """See `Reward`."""
        super().__init__(setup, robot_ids, missions)
        self._found = np.zeros((missions, 2))
        self._steps = np.zeros(missions, int)
        self._before: list[list[tuple[Place | None, float]]] = [[] for _ in range(missions)]
        self._to_victims: list[dict[tuple[float, Place], np.ndarray | None]] = [{} for _ in range(missions)]

    def begin(self, mission: int, setup: Setup) -> None:
        """See `Reward`."""
        self._found[mission], self._steps[mission] = 0.0, 0
        self._before[mission], self._to_victims[mission] = [(None, 0.0)] * len(self.robot_ids), {}

    def of_step(self, steps: Steps) -> np.ndarray:
        """See `Reward`."""
        which, found = steps.missions, np.column_stack((steps.explored, steps.saved))
        team = (found - self._found[which]) @ (self.AREA, self.VICTIM) + self.PER_S * self.setup.scenario.run.step_s
        rewards = team[:, None] + self.for_contacts(steps)
        self._found[which] = found
        self._steps[which] += 1
        for row in np.flatnonzero(self._steps[which] % 5 == 0).tolist():
            mission = int(which[row])
            record = steps.record_of(mission)
            rewards[row] += [self._progress(mission, agent, record) for agent in range(len(self.robot_ids))]
        return rewards

    def _progress(self, mission: int, agent: int, record: StepRecord) -> float:
        """Return the reward for having come nearer to a goal since the last call, if the robot still has it."""
        robot_id = self.robot_ids[agent]
        if not record.present[robot_id]:
            return 0.0
        position = tuple(record.state.positions_m[robot_id].tolist())
        goals = [
            (self._length_m(mission, robot_id, place, position, own), place)
            for place, own in self._goals(robot_id, record)
        ]
        length_m, goal = min(goals, default=(UNREACHABLE_M, None))
        (before, before_m), self._before[mission][agent] = self._before[mission][agent], (goal, length_m)
        per_metre = self.PER_METRE_TO_VOICE if record.voices[robot_id].heard else self.PER_METRE
        return per_metre * (before_m - length_m) if goal == before and length_m < UNREACHABLE_M > before_m else 0.0

    def _goals(self, robot_id: int, record: StepRecord) -> list[tuple[Place, bool]]:
        """Return the goals of a robot, and whether they are of this mission only."""
        if record.voices[robot_id].heard:
            states = zip(record.victims, record.mission.victims, strict=False)
            return [(victim.position, True) for victim, state in states if state != "saved"]
        area = record.mission.task.area_center_m
        return [] if area is None else [(area, False)]

    def _length_m(self, mission: int, robot_id: int, goal: Place, position: Place, is_own: bool) -> float:
        building, reach_m = self.setup.building, self.setup.robots[robot_id].reach_m
        if not is_own:
            lengths_m = building.shared(lengths_to, reach_m, goal)
        else:
            known = self._to_victims[mission]
            if (reach_m, goal) not in known:
                known[reach_m, goal] = lengths_to(building, reach_m, goal)
            lengths_m = known[reach_m, goal]
        grid = known_map(building, reach_m).grid
        start = grid.nearest_free(position, 1.0)
        return (
            UNREACHABLE_M if lengths_m is None or start is None else min(grid.value_at(lengths_m, start), UNREACHABLE_M)
        )


RULES: dict[str, Any] = {"observe": SearchObserve, "act": AheadAct, "reward": OwnProgress, "every": 5}


def training_batch(missions: int) -> BatchEnv:
    """Return the missions of a training, of 300 s each."""
    return BatchEnv(training_scenarios(), missions, **RULES, max_cycles=600)


class Judged(NamedTuple):
    """What a team has found in missions that share seeds; arrays have shape (missions,).

    score:   mean over the time limit of the share of areas and victims that are found: 1 if all were found at once.
    ends_s:  when each mission ended.
    """

    score: np.ndarray
    areas: np.ndarray
    victims: np.ndarray
    ends_s: np.ndarray

    @classmethod
    def of(cls, scenario: Scenario, records: Sequence[Sequence[StepRecord]]) -> Judged:
        """Return it from the records of each mission."""
        limit_s, number = scenario.mission.time_limit_s, scenario.num_victims + len(scenario.mission.areas)
        score = []
        for mission in records:
            times_s = np.array([record.mission.time_s for record in mission])
            found = np.array([record.mission.areas_explored + record.mission.victims_saved for record in mission])
            score.append(float(np.diff(found, prepend=0) @ (limit_s - times_s)) / (limit_s * number))
        last = [mission[-1].mission for mission in records]
        numbers = [(status.areas_explored, status.victims_saved, status.time_s) for status in last]
        return cls(np.array(score), *np.array(numbers).T)


def judge(choose: Callable[[np.ndarray], np.ndarray], missions: int, seed: int = HELD_OUT_SEED) -> Judged:
    """Judge a policy in the building that no training has seen.

    Args: choose: returns actions within [-1, 1], shape (n, 2), for observations, shape (n, size).
    """
    batch = BatchEnv(search_scenario(HELD_OUT), missions, **RULES)
    observations, is_running = batch.reset(seed), np.ones(missions, bool)
    records: list[list[StepRecord]] = [[] for _ in range(missions)]
    while is_running.any():
        actions = choose(observations.reshape(missions * batch.num_robots, -1))
        step = batch.step(actions.reshape(missions, batch.num_robots, -1))
        for i in np.flatnonzero(is_running):
            records[i].append(batch.record(i))
        is_running &= ~step.is_over
    return Judged.of(batch.setup(0).scenario, records)


def judge_controller(controller: str, missions: int, seed: int = HELD_OUT_SEED) -> Judged:
    """Judge a registered controller in the same missions."""
    scenario, records = search_scenario(HELD_OUT, controller), []
    for number in range(missions):
        run = scenario.run.model_copy(update={"seed": seed + number})
        simulation, mission = Simulation(resolve(scenario.model_copy(update={"run": run}))), []
        simulation.mission.start()
        while not mission or mission[-1].mission.state != "ended":
            mission.append(simulation.step())
        records.append(mission)
    return Judged.of(scenario, records)


class Training:
    """The clock of a training, in minutes of processor time without evaluations, its learning curve and its policy."""

    COLUMNS = ("algorithm", "seed", "minutes", "decisions", "score", "areas", "victims", "end_s")

    def __init__(self, algorithm: str, greedy: torch.nn.Module, options: argparse.Namespace) -> None:
        """Args: greedy: from observations to actions within [-1, 1].  options: of `options`."""
        self._algorithm, self._greedy, self._options = algorithm, greedy, options
        self._begin_s, self._wall_s, self._next_minutes = time.process_time(), time.perf_counter(), 0.0
        options.out.mkdir(parents=True, exist_ok=True)
        self._rows: list[tuple[object, ...]] = [self.COLUMNS]

    def goes_on(self, decisions: int, reward: float) -> bool:
        """Judge and write the policy when it is time, and return whether time is left. Args: decisions: so far."""
        options, now_s = self._options, time.process_time()
        minutes, wall_minutes = (now_s - self._begin_s) / 60.0, (time.perf_counter() - self._wall_s) / 60.0
        is_over = minutes >= options.minutes
        text = f"{minutes:5.2f} min of processor time ({wall_minutes:.1f} min), {decisions:8,} decisions"
        print(f"{text}, reward {reward:7.4f}", flush=True)
        if is_over or minutes >= self._next_minutes:
            self._next_minutes += options.minutes / options.evaluations
            judged = judge(self._choose, options.missions)
            means = [f"{values.mean():.4g}" for values in judged]
            self._rows.append((self._algorithm, options.seed, f"{minutes:.2f}", decisions, *means))
            print("      held out: score {}, areas {}, victims {}, end {} s".format(*means), flush=True)
            self._write()
            self._begin_s += time.process_time() - now_s
        return not is_over

    def _choose(self, observations: np.ndarray) -> np.ndarray:
        with torch.inference_mode():
            actions: np.ndarray = self._greedy(torch.from_numpy(observations)).numpy()
        return actions

    def _write(self) -> None:
        out = self._options.out
        with (out / "learning_curve.csv").open("w", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows(self._rows)
        rules = {key: RULES[key] for key in ("observe", "act", "every")}
        export_policy(self._greedy, out / "policy.pt", search_scenario(HELD_OUT), **rules)
        print(f"      {out / 'policy.pt'}", flush=True)


def options(description: str | None, out: str, arguments: Sequence[str] | None = None) -> argparse.Namespace:
    """Return the options of a training. Args: out: the default folder."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--out", type=folder_of, default=Path(out), metavar="DIR", help=f"of the policy; default {out}")
    parser.add_argument("--seed", type=positive_whole_number, default=1, help="of everything; default 1")
    parser.add_argument("--minutes", type=positive_number, default=20.0, help="of processor time; default 20")
    for name, default, text in (
        ("--batch", 48, "missions at once"),
        ("--evaluations", 8, "number of times that the policy is judged and written, besides the one before training"),
        ("--missions", 10, "held-out missions that judge it"),
    ):
        parser.add_argument(name, type=positive_whole_number, default=default, help=f"{text}; default {default}")
    found = parser.parse_args(arguments)
    if found.batch < len(TRAINING):
        parser.error(f"argument --batch: {found.batch} is below {len(TRAINING)}, the number of buildings")
    return found
