"""PSO and RPSO on robots: RDPSO without fractional memory, communication term and exclusion."""

from robotteamsim.control.rdpso.controller import RdpsoController
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Control


class RpsoController(RdpsoController):
    """RPSO (15): inertia w, local and global best, obstacles. No robot is excluded, and no link is kept."""

    def __init__(self, robot_id: int, scenario: Scenario, arrival: int = 1) -> None:
        super().__init__(robot_id, _changed(scenario, c4=0.0), arrival)

    @staticmethod
    def memory(control: Control) -> tuple[float, ...]:
        """Return the inertia, the weight of v[t]."""
        return (control.inertia,)


class PsoController(RpsoController):
    """PSO (14): inertia w, local and global best. Only obstacle avoidance while driving keeps robots off walls."""

    def __init__(self, robot_id: int, scenario: Scenario, arrival: int = 1) -> None:
        super().__init__(robot_id, _changed(scenario, c3=0.0), arrival)


def _changed(scenario: Scenario, **coefficients: float) -> Scenario:
    """Return a scenario with other coefficients, in which no robot is excluded."""
    exclusion = scenario.control.exclusion.model_copy(update={"enabled": False})
    control = scenario.control.model_copy(update={"exclusion": exclusion, **coefficients})
    return scenario.model_copy(update={"control": control})
