"""The random walk: a baseline that uses neither voices nor areas nor teammates."""

from robotteamsim.control.driving.path_controller import PathController, Situation
from robotteamsim.interface import Decision


class RandomWalkController(PathController):
    """Random straight legs over the known map, without any communication."""

    def decide(self, now: Situation) -> Decision:
        """Return the command towards the end of the current leg."""
        return self.drive(now, None)
