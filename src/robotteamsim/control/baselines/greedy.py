"""The greedy controller: each robot drives on its own to the loudest place nearby."""

from robotteamsim.control.driving.path_controller import PathController
from robotteamsim.control.rdpso.local_best import LocalBestFinder
from robotteamsim.control.rdpso.ruled_out import RuledOut
from robotteamsim.interface import Decision
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.swarm import Vector


class GreedyController(PathController):
    """In each iteration it drives to its local best, which is that of a swarm robot; it sends no messages.

    If it hears no voice, the local best is the nearby place with the shortest path to the area. Without an area it
    wanders.
    """

    def __init__(self, robot_id: int, scenario: Scenario, arrival: int = 1) -> None:
        super().__init__(robot_id, scenario, arrival)
        self._ruled_out = RuledOut(scenario)
        self._iteration_ns = round(scenario.control.iteration_s * 1e9)
        self._iteration = self._epoch = -1
        self._goal: Vector | None = None
        self._value = 0.0
        self._finder = LocalBestFinder(scenario)

    def decide(self) -> Decision:
        """Return the command towards the local best of this iteration."""
        if not self.is_running:
            return Decision()
        pose = self.pose()
        iteration = self.observation.sim_time_ns // self._iteration_ns
        if iteration != self._iteration:
            self._iteration = iteration
            self._look_around((pose.x_m, pose.y_m))
        return self.drive(pose, self._goal, local_best=self._value)

    def _look_around(self, position: Vector) -> None:
        if self.task.epoch != self._epoch:
            self._epoch = self.task.epoch
            self._ruled_out.clear()
        voice = self.observation.voice
        self._ruled_out.add(position, voice.local_best_m if voice.heard else None)
        area = self.task.area_center_m
        best = self._finder.find(self.map, self._ruled_out, voice, area, position)
        self._goal, self._value = (best.position, best.value) if best else (None, 0.0)
