"""The controllers of this package, with their keys. Each family is a file; this is the list of controllers."""

from typing import Annotated, Any, get_args

from pydantic import Discriminator, Tag

from robotteamsim.scenario.controllers.base import Control, OtherControl, is_policy_file
from robotteamsim.scenario.controllers.cover import CoverControl
from robotteamsim.scenario.controllers.frontier import FrontierControl
from robotteamsim.scenario.controllers.patrolling import ConscientiousReactiveControl, SebsControl
from robotteamsim.scenario.controllers.routes import BoustrophedonControl, InfotaxisControl
from robotteamsim.scenario.controllers.search import SearchControl
from robotteamsim.scenario.controllers.simple import GreedyControl, RandomWalkControl, RelayControl
from robotteamsim.scenario.controllers.swarms import DpsoControl, PsoControl, RdpsoControl, RpsoControl

__all__ = ["ALGORITHMS", "AnyControl", "Control", "OtherControl", "control_kind", "is_policy_file"]

DEFAULT = "rdpso"
"""The algorithm of a scenario that names none."""


def _tag(value: Any) -> str:
    name = value.get("algorithm", DEFAULT) if isinstance(value, dict) else getattr(value, "algorithm", DEFAULT)
    return f"<{name}>" if isinstance(name, str) and name in ALGORITHMS else "<another algorithm>"


AnyControl = Annotated[
    Annotated[RdpsoControl, Tag("<rdpso>")]
    | Annotated[RandomWalkControl, Tag("<random_walk>")]
    | Annotated[GreedyControl, Tag("<greedy>")]
    | Annotated[PsoControl, Tag("<pso>")]
    | Annotated[DpsoControl, Tag("<dpso>")]
    | Annotated[RpsoControl, Tag("<rpso>")]
    | Annotated[SebsControl, Tag("<sebs>")]
    | Annotated[ConscientiousReactiveControl, Tag("<conscientious_reactive>")]
    | Annotated[BoustrophedonControl, Tag("<boustrophedon>")]
    | Annotated[InfotaxisControl, Tag("<infotaxis>")]
    | Annotated[CoverControl, Tag("<cover>")]
    | Annotated[SearchControl, Tag("<search>")]
    | Annotated[FrontierControl, Tag("<frontier>")]
    | Annotated[RelayControl, Tag("<relay>")]
    | Annotated[OtherControl, Tag("<another algorithm>")],
    Discriminator(_tag),
]
"""The keys of any controller."""

ALGORITHMS: dict[str, type[Control]] = {
    tag.tag[1:-1]: kind for kind, tag in map(get_args, get_args(get_args(AnyControl)[0])) if kind is not OtherControl
}
"""The controllers of this package, by name."""


def control_kind(algorithm: Any) -> type[Control]:
    """Return the model of `control` for an algorithm."""
    return ALGORITHMS.get(algorithm, OtherControl) if isinstance(algorithm, str) else OtherControl
