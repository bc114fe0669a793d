"""Missions that make their steps together, in arrays: the usual case."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from robotteamsim import _core
from robotteamsim._core.state import DOOR_MOVED, LINKS_CHANGED, PLACE_REACHED, VOICE_CHANGED
from robotteamsim.interface import Decision, Message
from robotteamsim.learning.act import Commands
from robotteamsim.learning.episode import Episode
from robotteamsim.learning.observe import Percepts
from robotteamsim.learning.senses import composed
from robotteamsim.network.delivery import deliver_at_once
from robotteamsim.network.messages import NO_TRAFFIC, NetworkState, Traffic
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.simulation import StepRecord
from robotteamsim.world.world import World

_JUDGED = PLACE_REACHED | LINKS_CHANGED | VOICE_CHANGED | DOOR_MOVED
"""What makes a mission look at a step."""


class BatchStep(NamedTuple):
    """What a step of many missions has led to. The arrays are always the same ones, which the next step changes.

    observations: float32, shape (num_envs, robots, size); 0 for absent robots.
    rewards:      float32, shape (num_envs, robots).
    terminated, truncated: bool, shape (num_envs, robots), as of `TeamEnv`.
    is_over:      bool, shape (num_envs,): whose next step begins another mission.
    """

    observations: np.ndarray
    rewards: np.ndarray
    terminated: np.ndarray
    truncated: np.ndarray
    is_over: np.ndarray


class _Made(Sequence[Any]):
    """A sequence that is made when somebody looks at it."""

    def __init__(self, make: Callable[[], Sequence[Any]], length: int) -> None:
        self._make, self._length = make, length
        self._items: Sequence[Any] | None = None

    def _all(self) -> Sequence[Any]:
        if self._items is None:
            self._items = self._make()
        return self._items

    def __len__(self) -> int:
        return self._length

    def __getitem__(self, index: Any) -> Any:
        return self._all()[index]

    def __iter__(self) -> Iterator[Any]:
        return iter(self._all())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and list(self) == list(other)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return repr(self._all())

    def __reduce__(self) -> tuple[type[list[Any]], tuple[list[Any]]]:
        return list, (list(self),)


def _decisions(
    commands: Commands, robot_ids: Sequence[int], positions_m: np.ndarray
) -> tuple[Sequence[Decision], Sequence[Decision]]:
    """Return what a team decides in the first step of a command, and in those after it, in which nothing is sent."""
    first = _Made(lambda: commands.decisions(robot_ids, positions_m), len(robot_ids))
    return first, _Made(lambda: [Decision(one.twist) for one in first], len(robot_ids))


def _sensors(episode: Episode) -> RobotSensors:
    sensors = episode.check_begun().sensors
    assert isinstance(sensors, RobotSensors)
    return sensors


class Together:
    """Steps the missions of a batch in which nothing acts but robots that obey, each as its `Episode` would.

    The world, lasers, odometry, voices and links of all of them are one call. A mission judges a step only if something
    has happened in it. Messages are rows of an array; their text is made only for those who look at a record.
    """

    def __init__(self, episodes: Sequence[Episode], num_robots: int, threads: int) -> None:
        """Args: threads: 0: one per core."""
        self._episodes, observe = episodes, episodes[0].observe
        missions, robots = len(episodes), num_robots
        self._core = _core.simulation.Batch(missions, robots, observe.beams, threads)
        self.are_plain = np.zeros(missions, bool)
        """Which missions are stepped here, as of their beginning."""
        self._twists = np.zeros((missions, robots, 3))
        shape, said = (missions, robots), observe.said
        self.percepts = Percepts(
            np.zeros((*shape, observe.beams), np.float32),
            np.zeros((*shape, 4)),
            np.zeros((*shape, 3)),
            np.zeros((*shape, 4)),
            np.zeros((missions, 1, 3)),
            np.zeros((*shape, observe.teammates, 4 + said)),
            np.zeros((*shape, observe.remembered)),
        )
        """Of all missions."""
        self._heard = np.zeros((*shape, max(robots, observe.teammates + 1), 4 + said))
        self._map_T_odom = np.zeros((*shape, 4))
        self._nothing = np.zeros(robots)
        self._happened = np.ones(missions, bool)
        """Whether something has happened in the last step that a mission looks at."""
        self._steps_left = np.zeros(missions, int)
        """For how many steps the odometry of each mission has random numbers."""

    def begin(self, mission: int) -> None:
        """Take a mission over that has just begun, if it can be stepped here; note what its robots perceive."""
        self._note_alone(mission)
        episode = self._episodes[mission]
        rows = len(episode.robot_ids)
        is_alike = (episode.senses.map_T_odom is None) == (self._episodes[0].senses.map_T_odom is None)
        fits = is_alike and rows == self._twists.shape[1] and episode.observe.beams == self.percepts.ranges_m.shape[-1]
        self.are_plain[mission] = fits and episode.is_plain
        if self.are_plain[mission]:
            self._happened[mission] = True
            self._heard[mission] = episode.senses.heard
            episode.senses.heard = self._heard[mission]
            if episode.senses.map_T_odom is not None:
                self._map_T_odom[mission] = episode.senses.map_T_odom
            self._put(mission)

    def _note_alone(self, mission: int) -> None:
        """Note what the robots of a mission perceive that is stepped by its episode."""
        for array, part in zip(self.percepts, self._episodes[mission].percepts, strict=True):
            array[mission, : len(part)] = part

    def _put(self, mission: int) -> None:
        simulation = self._episodes[mission].check_begun()
        world, sensors = simulation.world, _sensors(self._episodes[mission])
        assert isinstance(world, World)
        links, ear = simulation.network.network.links, simulation.hearing.sensor.core()
        self._core.put(mission, world.core, sensors.core, links, ear, simulation.mission.places)
        self._steps_left[mission] = sensors.core.noise_left

    def step(self, missions: Sequence[int], commands: Commands, led_to: BatchStep) -> None:
        """Let the robots of some missions act. Args: commands: of all missions.  led_to: all but observations."""
        plain = [i for i in missions if self.are_plain[i]]
        if plain:
            self._step_plain(plain, commands, led_to)
        for i in missions:
            if self.are_plain[i]:
                continue
            episode = self._episodes[i]
            rows = len(episode.robot_ids)
            outcome = episode.step(Commands(commands.twists[i, :rows], commands.say[i, :rows]))
            led_to.rewards[i, :rows], led_to.terminated[i, :rows] = outcome.rewards, outcome.terminated
            led_to.truncated[i, :rows], led_to.is_over[i] = outcome.truncated, outcome.is_over
            self._note_alone(i)

    def _step_plain(self, missions: Sequence[int], commands: Commands, led_to: BatchStep) -> None:
        episodes, going = self._episodes, list(missions)
        self._twists[going] = commands.twists[going]
        positions_m = self.percepts.poses[..., :2].copy()
        decided = {i: _decisions(commands.of(i), episodes[i].robot_ids, positions_m[i]) for i in missions}
        for k in range(episodes[0].rules.every):
            for i in going:
                simulation, sensed, quiet = episodes[i].check_begun(), episodes[i].sensed, not self._happened[i]
                episodes[i].note(simulation.judge(sensed, decided[i][k > 0], is_quiet=quiet))
                if simulation.silence():
                    self._put(i)
            self._core.move(self._twists, going)
            state = self._core.sense(going)
            self._happened[going] = state.happened[going] & _JUDGED != 0
            self._steps_left[going] -= 1
            traffic = self._deliver(state, going, commands.say, positions_m) if k == 0 else {}
            for i in going:
                sent = decided[i][0] if k == 0 else None
                episodes[i].sensed = self._followed(i, state.of(i), traffic.get(i, NO_TRAFFIC), sent)
                if self._steps_left[i] == 0:
                    self._steps_left[i] = _sensors(episodes[i]).draw()
            if k + 1 == episodes[0].rules.every:
                self._note(state, going)
            elif ended := [i for i in going if not episodes[i].is_running]:
                self._note(state, ended)
                going = [i for i in going if episodes[i].is_running]
            if not going:
                break
        led_to.rewards[missions] = [episodes[i].earned for i in missions]
        has_ended, is_cut = np.array([episodes[i].count_cycle() for i in missions]).T
        led_to.terminated[missions], led_to.truncated[missions] = has_ended[:, None], (is_cut & ~has_ended)[:, None]
        led_to.is_over[missions] = has_ended | is_cut
        for i in missions:
            episodes[i].earned = self._nothing
            episodes[i].percepts = Percepts(*(part[i] for part in self.percepts))

    def _followed(
        self, mission: int, state: _core.state.State, traffic: Traffic, sent: Sequence[Decision] | None
    ) -> StepRecord:
        """Return the record of a step that the batch has made. Args: sent: the decisions whose messages arrive now."""
        network, robots = NetworkState(state, traffic), len(state)
        inboxes: Sequence[Sequence[Message]] = [()] * robots
        if sent is not None:

            def delivered() -> Sequence[Sequence[Message]]:
                outboxes = [decision.outbox for decision in sent]
                return deliver_at_once(network.hop_count, outboxes, network.fiedler_value > 0.0)

            inboxes = _Made(delivered, robots)
        return self._episodes[mission].check_begun().follow(state, network, inboxes)

    def _deliver(
        self, state: _core.state.State, missions: Sequence[int], say: np.ndarray, positions_m: np.ndarray
    ) -> dict[int, Traffic]:
        """Note what the robots hear of each other in the step after a decision, and return how many messages arrive.

        Args: say, positions_m: that each robot sends.
        """
        robots = self._twists.shape[1]
        hears = state.hop_count[missions] > 0  # by mission, receiver and sender: links are symmetric
        worlds = [self._episodes[i].check_begun().world for i in missions]
        shape = len(missions), robots, 1
        times_ns = np.broadcast_to(np.array([[[world.sim_time_ns + world.step_ns]] for world in worlds]), shape)
        rows = np.concatenate((np.ones(shape), positions_m[missions], times_ns, say[missions]), -1)[:, None]
        self._heard[missions, :, :robots] = np.where(hears[..., None], rows, self._heard[missions, :, :robots])
        copies = robots * (robots - 1)
        return {
            i: Traffic(delivered=count, cut_off=copies - count, mean_delay_s=world.step_ns / 1e9 if count else 0.0)
            for i, world, count in zip(missions, worlds, hears.sum((1, 2)).tolist(), strict=True)
        }

    def _note(self, state: _core.state.State, missions: Sequence[int]) -> None:
        """Note what the robots of these missions perceive now."""
        which, percepts = missions, self.percepts
        percepts.ranges_m[which] = state.ranges_m[which]
        senses = self._episodes[missions[0]].senses
        if senses.map_T_odom is None:
            percepts.poses[which] = state.true_pose[which]
        else:
            percepts.poses[which] = composed(self._map_T_odom[which], state.odometry_pose[which])
        percepts.twists[which] = state.odometry_twist[which]
        voices = percepts.voices
        voices[which, :, 0], voices[which, :, 1] = state.voice_heard[which], state.local_best_level_db[which]
        voices[which, :, 2:] = state.local_best_m[which]
        times_ns = np.array([self._episodes[i].sensed.sim_time_ns for i in missions])[:, None, None]
        agents, senders = senses.of_others
        percepts.heard[which] = heard = self._heard[np.array(which)[:, None, None], agents, senders]
        percepts.heard[which, :, :, 3] = (times_ns - heard[..., 3]) * 1e-9
        for i in missions:
            area = self._episodes[i].sensed.task.area_center_m
            percepts.area[i] = (0.0, 0.0, 0.0) if area is None else (1.0, *area)
