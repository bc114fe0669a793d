"""Only regular files are read; anything else is rejected before it blocks or fills the memory."""

from __future__ import annotations

import os
import re
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


_ROOT = Path(__file__).parents[2]
_READS = re.compile(
    r"\b(open_regular|read_text\(path|ezdxf\.readfile|ezdwg\.read|ifcopenshell\.open|fdsreader\.Simulation|sqlite3\.connect|torch\.load)\b"
)
_READERS = {
    "cache.py": "cache of imported plans",
    "campaign/store.py": "`campaign.sqlite`",
    "hazards/fds.py": "results of FDS",
    "learning/policy_file.py": "a policy (`policy.pt`)",
    "map_import/cells.py": "image (PNG",
    "recording/bag_file.py": "bag (ROS 1, MCAP, SQLite",
    "recording/bag_reader.py": "bag (ROS 1, MCAP, SQLite",
    "recording/bag_writer.py": "bag (ROS 1, MCAP, SQLite",  # what an earlier program has left
    "recording/ros_recorder.py": "bag (ROS 1, MCAP, SQLite",
    "formats/importer.py": "drawing (DXF, DWG)",  # and others, to find out what it is
    "formats/ifc_file.py": "building (IFC)",
    "recording/results.py": "`mission.json`",
    "scenario/cad_content.py": "drawing (DXF, DWG)",
    "scenario/dwg.py": "drawing (DXF, DWG)",
    "scenario/patrol.py": "patrol graph",
    "scenario/yaml_text.py": "scenario, floor plan, map yaml",
    "stage/world_file.py": "world of Stage",
}
"""What each module reads, as SECURITY.md calls it."""


def test_security_page_names_each_format_that_is_read():
    package = _ROOT / "src" / "robotteamsim"
    reading = {
        path.relative_to(package).as_posix() for path in package.rglob("*.py") if _READS.search(path.read_text("utf-8"))
    }
    assert reading - {"user_files.py"} == set(_READERS)
    rows = [
        line.split("|")[1].strip() for line in (_ROOT / "SECURITY.md").read_text("utf-8").splitlines() if "|" in line
    ]
    assert [name for name in _READERS.values() if not any(name in row for row in rows)] == []
