"""Starts a node's script; its module is imported here, so that it can be interrupted from the beginning."""

import importlib
import signal


def start(node: str, function: str = "main") -> None:
    """Call a function of a module of `robotteamsim.ros.nodes`."""
    # Imports take a second or more; Ctrl-C, or the end of a launch, would end them with a traceback.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    getattr(importlib.import_module(f"robotteamsim.ros.nodes.{node}"), function)()
