"""`send` of the tests returns when the message has come, in nodes of rospy and of roscpp."""

from __future__ import annotations

import gc
import warnings

import pytest
import rospy
from contract_over_ros import RELAXED, master  # noqa: F401 - a fixture
from listening import Topic, num_received, send
from rosgraph_msgs.msg import Log
from running import Program

pytestmark = RELAXED

RECEIVED = [["/other", [[0, 12, 1, 0, 0]]], ["/robot_0/cmd_vel", [[3, 400, 5, -1, 1], [7, 160, 2, -1, 1]]]]
"""Two publishers have sent 5 and 2 messages of the second topic."""
PUBLISHED = [["/robot_0/cmd_vel", 900, [[1, 900, 9, 1]]]]


@pytest.mark.parametrize("answer", [[1, "", [PUBLISHED, RECEIVED, []]], [PUBLISHED, RECEIVED]], ids=["rospy", "roscpp"])
def test_messages_of_all_publishers_are_counted_in_both_forms_of_the_answer(answer: list[object]) -> None:
    assert num_received(answer, "/robot_0/cmd_vel") == 7
    assert num_received(answer, "/other") == 1


def test_send_waits_for_a_node_of_roscpp_and_leaves_no_socket_open(master: Program) -> None:  # noqa: F811
    # rosout, which each master starts, is such a node; it repeats what it has received.
    repeated = Topic("/rosout_agg", Log)
    publisher = rospy.Publisher("/rosout", Log, queue_size=10, tcp_nodelay=True)
    assert repeated.is_connected(60.0)
    send(publisher, Log(msg="first"))
    gc.collect()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", ResourceWarning)
        send(publisher, Log(msg="second"))
        gc.collect()
    assert [str(warning.message) for warning in caught] == []
    repeated.wait_for_after(0, lambda message: message.msg == "second", "the text")
