"""The greedy controller: each robot drives on its own to the loudest place nearby."""

from robotteamsim.control.driving.path_controller import PathController, Situation
from robotteamsim.control.rdpso.terms import LocalBestFinder, RuledOut
from robotteamsim.interface import Decision
from robotteamsim.scenario.controllers.simple import GreedyControl
from robotteamsim.setup import Setup
from robotteamsim.swarm import Vector


class GreedyController(PathController):
    """In each iteration it drives to its local best, which is that of a swarm robot; it sends no messages.

    If it hears no voice, the local best is the nearby place with the shortest path to the area. Without an area it
    wanders.
    """

    def __init__(self, robot_id: int, setup: Setup, arrival: int = 1) -> None:
        super().__init__(robot_id, setup, arrival)
        self._ruled_out = RuledOut(setup.scenario, setup.scenario.control.as_kind(GreedyControl).rule_out_places)
        self._iteration_ns = round(setup.scenario.control.iteration_s * 1e9)
        self._iteration = self._epoch = -1
        self._goal: Vector | None = None
        self._value = 0.0
        self._finder = LocalBestFinder(setup.scenario)

    def decide(self, now: Situation) -> Decision:
        """Return the command towards the local best of this iteration."""
        iteration = now.observation.sim_time_ns // self._iteration_ns
        if iteration != self._iteration:
            self._iteration = iteration
            self._look_around(now)
        return self.drive(now, self._goal, local_best=self._value, local_best_m=self._goal)

    def _look_around(self, now: Situation) -> None:
        if now.task.epoch != self._epoch:
            self._epoch = now.task.epoch
            self._ruled_out.clear()
        voice = now.observation.voice
        self._ruled_out.add(now.position, voice.local_best_m if voice.heard else None)
        best = self._finder.find(self.driver.map, self._is_vain, voice, now.task.area_center_m, now.position)
        self._goal, self._value = (best.position, best.value) if best else (None, 0.0)

    def _is_vain(self, place: Vector) -> bool:
        """Whether no victim can be where a voice is heard, or the robot cannot go there, because it is hot."""
        return self._ruled_out.covers(place) or self.driver.hot.is_hot(place)
