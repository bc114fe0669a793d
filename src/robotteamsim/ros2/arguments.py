"""Parameters on the command line of a node of ROS 2."""

from __future__ import annotations

import itertools
from collections.abc import Sequence


def given_parameters(arguments: Sequence[str]) -> list[str]:
    """Return the names of the parameters of the simulation that `-p name:=value` sets after `--ros-args`."""
    of_ros = itertools.takewhile("--".__ne__, itertools.dropwhile("--ros-args".__ne__, arguments))
    texts = [text for option, text in itertools.pairwise(of_ros) if option in ("-p", "--param")]
    names = (text.partition(":=")[0].rpartition(":") for text in texts)
    return [name for node, _, name in names if node.strip("/") in ("", "simulation", "**")]
