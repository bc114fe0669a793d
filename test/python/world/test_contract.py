"""Each world keeps the contract of worlds."""

import pytest

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.worlds import OURS
from robotteamsim.testing import check_world


@pytest.mark.slow
@pytest.mark.parametrize("world", OURS)
def test_world_keeps_the_contract(world):
    check_world(world)


def test_unknown_world_is_named():
    with pytest.raises(ScenarioError, match=r"^check_world: no world 'box3d'; known: box2d, mujoco; did you mean "):
        check_world("box3d")
