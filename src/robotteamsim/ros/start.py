"""Starts a node's script; its module is imported here, so that it can be interrupted from the beginning."""

import importlib


def start(node: str, function: str = "main") -> None:
    """Call a function of a module of `robotteamsim.ros.nodes`; the script has SIGINT end the process until then."""
    getattr(importlib.import_module(f"robotteamsim.ros.nodes.{node}"), function)()
