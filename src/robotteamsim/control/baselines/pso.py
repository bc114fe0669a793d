"""PSO, DPSO and RPSO on robots: RDPSO without fractional memory, communication term and exclusion."""

from robotteamsim.control.rdpso.controller import RdpsoController
from robotteamsim.control.rdpso.membership import DpsoMembership
from robotteamsim.scenario.controllers.swarms import (
    DpsoControl,
    PsoControl,
    RdpsoControl,
    RpsoControl,
    SocialExclusion,
)
from robotteamsim.setup import Setup

_NO_EXCLUSION = SocialExclusion(enabled=False)


class RpsoController(RdpsoController):
    """RPSO (15): inertia w, local and global best, obstacles. No robot is excluded, and no link is kept."""

    def __init__(self, robot_id: int, setup: Setup, arrival: int = 1) -> None:
        own = setup.scenario.control.as_kind(RpsoControl)
        control = own.as_kind(RdpsoControl, c4=0.0, exclusion=_NO_EXCLUSION)
        super().__init__(robot_id, setup.with_control(control), arrival, memory=(own.inertia,))


class PsoController(RdpsoController):
    """PSO (14): inertia w, local and global best. Only obstacle avoidance while driving keeps robots off walls."""

    def __init__(self, robot_id: int, setup: Setup, arrival: int = 1) -> None:
        own = setup.scenario.control.as_kind(PsoControl)
        control = own.as_kind(RdpsoControl, c3=0.0, c4=0.0, exclusion=_NO_EXCLUSION)
        super().__init__(robot_id, setup.with_control(control), arrival, memory=(own.inertia,))


class DpsoController(RdpsoController):
    """DPSO: several swarms that each move by PSO (14), with natural selection (12, 13)."""

    membership = DpsoMembership

    def __init__(self, robot_id: int, setup: Setup, arrival: int = 1) -> None:
        own = setup.scenario.control.as_kind(DpsoControl)
        control = own.as_kind(RdpsoControl, c3=0.0, c4=0.0)
        super().__init__(robot_id, setup.with_control(control), arrival, memory=(own.inertia,))
