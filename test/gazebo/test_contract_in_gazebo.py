"""Gazebo behind ROS: the tests of the contract of worlds that it passes.

Gazebo follows the clock of this process, so that it takes one step at a time. docs/gazebo_missions.md lists what it
does not have: poses that are set, robots that leave or arrive, and objects on topics.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
import rospy
from contract_over_ros import RELAXED, master, readings_of  # noqa: F401 - fixtures
from ros_world import RosWorld
from rosgraph_msgs.msg import Clock
from running import Program, running

from robotteamsim.gazebo import export_world
from robotteamsim.geometry import Twist
from robotteamsim.setup import resolve
from robotteamsim.testing.contract.doors_and_objects import (  # noqa: F401 - tests
    test_instant_door_stops_robots_only_while_it_is_closed,
    test_leaf_moves_at_constant_speed_and_the_door_is_closed_when_it_has_arrived,
    test_robot_does_not_push_a_leaf,
    test_unknown_door_is_named,
)
from robotteamsim.testing.contract.motion import (  # noqa: F401 - tests
    test_car_does_not_turn_on_the_spot,
    test_differential_drive_ignores_a_command_to_the_side,
    test_drives_follow_their_commands,
    test_robot_brakes_when_its_command_ends,
    test_robot_comes_free_again,
    test_robots_do_not_pass_through_each_other,
    test_speeds_and_accelerations_stay_within_the_drive,
    test_walls_and_blocks_stop_a_robot,
)
from robotteamsim.testing.contract.team import (  # noqa: F401 - tests
    test_lasers_see_a_closed_door_and_not_an_open_one,
    test_lasers_see_walls_objects_and_robots,
)
from robotteamsim.testing.contract.two_rooms import scenario_of

pytestmark = RELAXED


@pytest.fixture
def world_of(master: Program, gzserver: tuple[str, ...], tmp_path: Path) -> Iterator[Callable[..., RosWorld]]:  # noqa: F811
    """Start Gazebo with a scenario of the suite."""
    with ExitStack() as stack:

        def make(*robots: object, **keys: object) -> RosWorld:
            scenario = scenario_of("box2d", *robots, **keys)
            path = tmp_path / "test.world"
            path.write_text(export_world(resolve(scenario)).text)
            rospy.set_param("/gazebo", {"follow_clock": True, "speed": 0.0})
            clock = rospy.Publisher("/clock", Clock, queue_size=10, tcp_nodelay=True, latch=True)
            stack.callback(clock.unregister)
            stack.enter_context(running((*gzserver, "--verbose", str(path)), tmp_path, master.port))
            world = RosWorld(scenario, lambda time_ns: clock.publish(rospy.Time(nsecs=time_ns)), has_presence=False)
            stack.callback(world.close)
            return world

        yield make


def test_command_holds_for_eight_steps_and_then_the_robot_stops(world_of: Callable[..., RosWorld]) -> None:
    world = world_of((2.0, 2.0, 0.0))
    world.step([Twist(0.5)])
    for _ in range(12):
        world.advance()
    assert world.twists()[0].linear_x_mps == pytest.approx(0.0, abs=1e-3)
    assert world.poses()[0].x_m == pytest.approx(2.4, abs=0.01)
