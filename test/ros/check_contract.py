"""Our own world behind ROS: the tests of the contract of worlds that make sense over topics and services.

Run by test_contract.py in a process of its own.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
import rospy
from contract_over_ros import RELAXED, master, readings_of, write_scenario  # noqa: F401 - fixtures
from robotteamsim.srv import Step
from ros_world import RosWorld
from running import Program, running

from robotteamsim.geometry import Twist
from robotteamsim.testing.contract.doors_and_objects import (  # noqa: F401 - tests
    test_instant_door_stops_robots_only_while_it_is_closed,
    test_leaf_waits_for_a_robot_and_does_not_push_it,
    test_unknown_door_is_named,
)
from robotteamsim.testing.contract.motion import (  # noqa: F401 - tests
    test_robot_that_meets_a_wall_at_an_angle_touches_it_there,
    test_robots_do_not_pass_through_each_other,
    test_speeds_and_accelerations_stay_within_the_drive,
    test_time_is_counted_in_whole_steps,
)
from robotteamsim.testing.contract.team import (  # noqa: F401 - tests
    test_absent_robot_has_no_body_and_no_pose,
    test_lasers_see_a_closed_door_and_not_an_open_one,
    test_removed_robot_blocks_nobody_and_can_return,
    test_schedule_moves_robots_and_doors,
)
from robotteamsim.testing.contract.two_rooms import scenario_of

pytestmark = RELAXED

NODE = Path(__file__).parents[2] / "scripts" / "simulation"


@pytest.fixture
def world_of(master: Program, tmp_path: Path) -> Iterator[Callable[..., RosWorld]]:  # noqa: F811
    """Start the node `world`, paused, with a scenario of the suite."""
    with ExitStack() as stack:

        def make(*robots: object, **keys: object) -> RosWorld:
            scenario = scenario_of("box2d", *robots, **keys)
            common = {"scenario": str(write_scenario(scenario, tmp_path)), "controllers": "none", "mission": False}
            rospy.set_param("/robotteamsim", common)
            rospy.set_param("/simulation", {"paused": True, "speed": 1000.0})
            stack.enter_context(running((sys.executable, str(NODE), "__name:=simulation"), tmp_path, master.port))
            rospy.wait_for_service("/simulation/step", timeout=60.0)
            step = rospy.ServiceProxy("/simulation/step", Step, persistent=True)
            stack.callback(step.close)
            world = RosWorld(scenario, lambda _time_ns: step(steps=1), has_presence=True)
            stack.callback(world.close)
            return world

        yield make


def test_command_holds_for_eight_steps_and_then_the_robot_stops(world_of: Callable[..., RosWorld]) -> None:
    world = world_of((2.0, 2.0, 0.0))
    world.step([Twist(0.5)])
    speeds_mps = [world.twists()[0].linear_x_mps]
    for _ in range(12):
        world.advance()
        speeds_mps.append(world.twists()[0].linear_x_mps)
    # It speeds up at 2 m/s^2 for two and a half steps, and slows down as long.
    assert sum(speed_mps > 0.49 for speed_mps in speeds_mps) == 5
    assert world.poses()[0].x_m == pytest.approx(2.4, abs=0.01)
    assert speeds_mps[-1] == pytest.approx(0.0, abs=1e-6)
