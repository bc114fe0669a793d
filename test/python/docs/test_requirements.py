"""Every package that .venv and the environments of ROS 2 get is pinned by version and hash."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

SETUP = Path(__file__).parents[3] / "setup"


def _pins(name: str) -> dict[str, str]:
    lines = (SETUP / name).read_text(encoding="utf-8").splitlines()
    found = (re.match(r"([A-Za-z0-9._-]+)==([^ ]+)", line) for line in lines)
    return {re.sub("[._-]+", "-", pin[1]).lower(): pin[2] for pin in found if pin}


NAMES = ("requirements-run", "requirements-wheel", "requirements")
"""Each includes the one before it."""
ROS2 = tuple((NAMES[0], "requirements-ros2", f"requirements-{name}") for name in ("jazzy", "kilted"))


@pytest.mark.parametrize("names", [NAMES[:1], NAMES[:2], NAMES, *ROS2])
def test_lock_has_the_versions_of_the_requirements_and_hashes_of_all(names):
    lock = f"{names[-1]}.lock"
    wanted = {name: pin for file in names for name, pin in _pins(f"{file}.txt").items()}
    locked = _pins(lock)
    assert {name: locked.get(name) for name in wanted} == wanted, "run `make lock`"
    text = (SETUP / lock).read_text(encoding="utf-8")
    blocks = re.split(r"\n(?=[A-Za-z0-9])", text.strip())
    assert len(blocks) == len(locked)
    assert all("--hash=sha256:" in block for block in blocks)
    assert "file:/" not in text


def test_notices_of_compiled_libraries_are_there_and_in_the_wheel():
    root = SETUP.parent
    wheel = tomllib.loads((root / "pyproject.toml").read_text())["tool"]["scikit-build"]["wheel"]
    assert {"LICENSE", "LICENSES/*"} <= set(wheel["license-files"])
    page = (root / "LICENSES" / "README.md").read_text()
    for library in ("Box2D", "Eigen", "Spectra", "nanobind", "robin-map", "three.js"):
        (notice,) = re.findall(rf"^\| \[{re.escape(library)}\].*?\]\((\w[^:)]*\.txt)\)", page, re.MULTILINE)
        assert (root / "LICENSES" / notice).stat().st_size > 500
