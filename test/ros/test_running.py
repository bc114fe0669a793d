"""Programs of these tests have ports of their own."""

from __future__ import annotations

import socket
from pathlib import Path

import pytest
from running import ROSCORE, running, wait_for_port


def test_port_of_a_master_is_given_to_nobody_else_before_the_master_listens(tmp_path: Path) -> None:
    with (
        running(("sleep", "60"), tmp_path) as program,
        socket.socket() as other,
        pytest.raises(OSError, match="Address already in use"),
    ):
        other.bind(("localhost", program.port))
    with running(ROSCORE, tmp_path) as core:
        wait_for_port(core.port)
        core.wait_for(lambda line: "started core service" in line, "the start of its services")
