"""The random walk: a baseline that uses neither voices nor areas nor teammates."""

from robotteamsim.control.driving.path_controller import PathController
from robotteamsim.interface import Decision


class RandomWalkController(PathController):
    """Random straight legs over the known map, without any communication."""

    def decide(self) -> Decision:
        """Return the command towards the end of the current leg."""
        return self.drive(self.pose(), None) if self.is_running else Decision()
