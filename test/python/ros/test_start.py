"""Start of a node's script."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

NODE = """
import os, sys, types
import robotteamsim.nodes.start

def main():
    print(os.environ["OPENBLAS_NUM_THREADS"])

sys.modules["robotteamsim.ros.nodes.made_up"] = types.SimpleNamespace(main=main)
robotteamsim.nodes.start.start("made_up")
"""


@pytest.mark.parametrize(("wanted", "used"), [(None, "1"), ("3", "3")])
def test_node_has_one_thread_for_numpy_unless_asked_for_more(wanted, used):
    environment = {name: value for name, value in os.environ.items() if name != "OPENBLAS_NUM_THREADS"}
    if wanted is not None:
        environment["OPENBLAS_NUM_THREADS"] = wanted
    node = subprocess.run(
        [sys.executable, "-c", NODE], env=environment, capture_output=True, text=True, check=True, timeout=60
    )
    assert node.stdout == f"{used}\n"
