"""Parameters on the command line of a node of ROS 2."""

from __future__ import annotations

import itertools
from collections.abc import Sequence


def given_parameters(arguments: Sequence[str]) -> list[str]:
    """Return the names of the parameters that `-p name:=value` sets."""
    pairs = itertools.pairwise(arguments)
    return [text.partition(":=")[0].rpartition(":")[2] for option, text in pairs if option in ("-p", "--param")]
