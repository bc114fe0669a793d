"""The package on systems that are not POSIX."""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

IMPORT_ALL = """
import importlib, importlib.util, pkgutil, sys

HIDDEN = ("fcntl", "grp", "posix_ipc", "pwd", "resource", "termios", "tty")
# Libraries may import what this system has.
LIBRARIES = ("cv2", "distributed", "filelock", "matplotlib.pyplot", "rosbags.rosbag1", "statsmodels.api")
for library in LIBRARIES:
    importlib.import_module(library)
for name in HIDDEN:
    sys.modules[name] = None

import robotteamsim

names = [module.name for module in pkgutil.walk_packages(robotteamsim.__path__, "robotteamsim.")]
names = [name for name in names if not name.startswith("robotteamsim.ros")]
names = [name for name in names if name.split(".")[1] not in ("msg", "srv") and not name.endswith("__main__")]
if importlib.util.find_spec("torchrl") is None:  # its class derives from one of this optional package
    names.remove("robotteamsim.learning.torchrl_env")
for name in names:
    importlib.import_module(name)
print(len(names))
"""


@pytest.mark.slow
def test_every_module_but_those_for_ros_is_imported_without_posix_modules():
    done = subprocess.run([sys.executable, "-c", IMPORT_ALL], capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 150


def test_wheels_are_configured_for_three_systems_and_the_stable_abi_of_python():
    root = Path(__file__).parents[2]
    tools = tomllib.loads((root / "pyproject.toml").read_text())["tool"]
    settings = tools["cibuildwheel"]
    assert (settings["build"], tools["scikit-build"]["wheel"]["py-api"]) == ("cp311-*", "cp311")
    for system in ("linux", "macos", "windows"):
        _, script, _ = settings[system]["before-all"].split()
        assert (root / script).is_file()


def test_sources_of_libraries_in_wheels_are_commits_which_cannot_change():
    lines = (Path(__file__).parents[2] / "setup" / "wheel-libraries.sh").read_text().splitlines()
    libraries = {words[1].rsplit("/", 1)[1]: words[2] for words in map(str.split, lines) if words[:1] == ["install"]}
    assert set(libraries) == {"eigen", "spectra", "box2d"}
    assert all(re.fullmatch(r"[0-9a-f]{40}", commit) for commit in libraries.values()), libraries
