"""Only regular files are read; anything else is rejected before it blocks or fills the memory."""

from __future__ import annotations

import os
import socket
from pathlib import Path

import pytest

from robotteamsim.user_files import open_regular


def test_regular_file_is_read_also_by_a_link(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"text")
    (tmp_path / "b").symlink_to("a")
    with open_regular(tmp_path / "b") as file:
        assert file.read() == b"text"


@pytest.mark.parametrize(
    ("kind", "reason"),
    [
        ("fifo", "not a regular file"),
        ("device", "not a regular file"),
        ("socket", "No such device or address"),
        ("folder", "Is a directory"),
        ("nothing", "No such file or directory"),
    ],
)
def test_anything_else_is_rejected_with_its_name(tmp_path: Path, kind: str, reason: str) -> None:
    path = tmp_path / "x"
    match kind:
        case "fifo":
            os.mkfifo(path)
        case "device":
            path.symlink_to("/dev/zero")
        case "folder":
            path.mkdir()
        case "socket":
            with socket.socket(socket.AF_UNIX) as bound:
                bound.bind(str(path))
    with pytest.raises(OSError, match=reason) as raised:
        open_regular(path)
    assert raised.value.filename == str(path)
