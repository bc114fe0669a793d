"""PSO, DPSO and RPSO on robots: RDPSO without fractional memory, communication term and exclusion."""

from robotteamsim.control.rdpso.controller import RdpsoController
from robotteamsim.control.rdpso.natural_selection import DpsoMembership
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import Control


class RpsoController(RdpsoController):
    """RPSO (15): inertia w, local and global best, obstacles. No robot is excluded, and no link is kept."""

    def __init__(self, robot_id: int, scenario: Scenario, arrival: int = 1) -> None:
        super().__init__(robot_id, _without_exclusion(scenario, c4=0.0), arrival)

    @staticmethod
    def memory(control: Control) -> tuple[float, ...]:
        """Return the inertia, the weight of v[t]."""
        return (control.inertia,)


class PsoController(RpsoController):
    """PSO (14): inertia w, local and global best. Only obstacle avoidance while driving keeps robots off walls."""

    def __init__(self, robot_id: int, scenario: Scenario, arrival: int = 1) -> None:
        super().__init__(robot_id, _without_exclusion(scenario, c3=0.0), arrival)


class DpsoController(RdpsoController):
    """DPSO: several swarms that each move by PSO (14), with natural selection (12, 13)."""

    membership = DpsoMembership

    def __init__(self, robot_id: int, scenario: Scenario, arrival: int = 1) -> None:
        super().__init__(robot_id, _with(scenario, c3=0.0, c4=0.0), arrival)

    @staticmethod
    def memory(control: Control) -> tuple[float, ...]:
        """Return the inertia, the weight of v[t]."""
        return (control.inertia,)


def _without_exclusion(scenario: Scenario, **coefficients: float) -> Scenario:
    """Return a scenario with other coefficients, in which no robot is excluded."""
    exclusion = scenario.control.exclusion.model_copy(update={"enabled": False})
    return _with(scenario, exclusion=exclusion, **coefficients)


def _with(scenario: Scenario, **keys: object) -> Scenario:
    """Return a scenario with other keys of `control`."""
    return scenario.model_copy(update={"control": scenario.control.model_copy(update=keys)})
