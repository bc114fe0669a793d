"""A waiting node ends on request."""

from __future__ import annotations

import contextlib
import gc
import signal
import subprocess
import sys
import xmlrpc.client
from collections.abc import Iterator

import pytest
import rosgraph
from peers import master, wait_until
from running import TIMEOUT_S

# rosgraph leaves its sockets to the garbage collector.
pytestmark = pytest.mark.filterwarnings("ignore")

WAITING_NODE = """
import sys
from robotteamsim.ros.node import on_shutdown, run
from robotteamsim.ros.topics import RoscppOutput
from robotteamsim.nodes.steps import Steps

def serve():
    words = RoscppOutput("/words", "std_msgs/String", latched=True)
    words.publish({"data": "before"})
    words.publish({"data": "heard late"})
    steps = Steps("/pace", lambda *_: ["/pace"], print)
    on_shutdown(steps.close)
    print("serving", flush=True)
    assert steps.take() is None
    print("closed", flush=True)

run("waiting", serve)
"""


@pytest.fixture(scope="module")
def ros(tmp_path_factory) -> Iterator[dict[str, str]]:
    """A master; the environment of its nodes."""
    with master(tmp_path_factory.mktemp("node_end")) as variables:
        yield variables
        gc.collect()  # while its warnings are ignored


def kill_by_master(node: str) -> None:
    """End a node as `rosnode kill` does."""
    uri = rosgraph.Master("/test").lookupNode(node)
    with contextlib.suppress(ConnectionError):  # rospy may end before it answers.
        xmlrpc.client.ServerProxy(uri).shutdown("/test", "the test asks for it")


def registrations(node: str) -> list[str]:
    """Return the topics and services that a node has at the master."""
    publishers, subscribers, services = rosgraph.Master("/test").getSystemState()
    return [name for name, nodes in (*publishers, *subscribers, *services) if node in nodes]


@pytest.mark.parametrize(
    "end",
    [
        lambda process: process.send_signal(signal.SIGINT),
        lambda process: process.send_signal(signal.SIGTERM),
        lambda process: process.send_signal(signal.SIGHUP),
        lambda _: kill_by_master("/renamed"),
        lambda _: kill_by_master("/renamed_topics"),
    ],
    ids=["SIGINT", "SIGTERM", "SIGHUP", "shutdown", "shutdown of its topics"],
)
def test_waiting_node_ends_cleanly_on_shutdown(ros, end):
    command = [sys.executable, "-c", WAITING_NODE, "__name:=renamed"]
    with subprocess.Popen(command, env=ros, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "serving\n"
        end(process)
        output, _ = process.communicate(timeout=TIMEOUT_S)
        assert output.splitlines()[-1] == "closed"
        assert process.returncode == 0
    for node in ("/renamed", "/renamed_topics"):
        wait_until(lambda node=node: not registrations(node), f"the end of the registration of {node}")


def test_late_subscriber_receives_the_last_message_of_a_latched_topic(ros):
    with subprocess.Popen([sys.executable, "-c", WAITING_NODE], env=ros, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout.readline() == "serving\n"
        echo = subprocess.run(
            ["rostopic", "echo", "-n", "1", "/words"], env=ros, capture_output=True, text=True, timeout=TIMEOUT_S
        )
        process.terminate()
    assert echo.stdout.splitlines()[0] == 'data: "heard late"'


def test_node_with_a_name_that_roscpp_refuses_ends_with_one_line(ros):
    command = [sys.executable, "-c", WAITING_NODE, "__name:=my-node"]
    result = subprocess.run(command, env=ros, capture_output=True, text=True, timeout=TIMEOUT_S)
    assert result.returncode == 2
    assert "/my-node_topics: not a name of a node" in result.stderr
    assert "Traceback" not in result.stderr
