"""The random walk: a baseline that uses neither voices nor areas nor teammates."""

from robotteamsim.control.driving.path_controller import PathController
from robotteamsim.interface import Decision


class RandomWalkController(PathController):
    """Random straight legs over the known map; it hears and says nothing."""

    def decide(self) -> Decision:
        """Return the command towards the end of the present leg."""
        return self.drive(self.pose(), None) if self.is_running else Decision()
