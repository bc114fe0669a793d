"""Modules import only from floors below their own; ROS stays in the ROS shell, and chance in named streams."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "src" / "robotteamsim"

FLOORS = (
    ("errors", "geometry", "rng", "wording", "_core"),
    ("scenario", "plan"),  # C++ calls it plan
    ("world", "propagation"),
    ("sensing", "network"),
    ("swarm",),
    ("interface",),
    ("control",),
    ("mission",),
    ("simulation",),
    ("recording",),
    ("campaign",),
    ("analysis",),
    ("cli", "ros"),
)
FLOOR_OF = {part: floor for floor, parts in enumerate(FLOORS) for part in parts}

ROS = re.compile(r"(rospy|roslib|roslaunch|rosgraph|rospkg|rosbag|genpy|tf|tf2_ros|\w+_(msgs|srvs))(\.|$)")
ROS_MESSAGES = re.compile(r"robotteamsim\.(msg|srv)(\.|$)")

OTHER_CHANCE = re.compile(
    r"random_device|mt19937|minstd_rand|\bs?rand\(|default_rng|RandomState|np\.random\.(?!Generator\b)"
    r"|\b(import|from) random\b|\bsecrets\b|urandom|\buuid"
)

PYTHON_FILES = sorted(PACKAGE.rglob("*.py"))
CPP_FILES = sorted(path for top in ("include", "src/cpp") for path in (ROOT / top).rglob("*.[ch]pp"))


def part_of(path: Path, top: Path) -> str:
    """Return the package, or the module of the ground floor, that a file belongs to."""
    first = path.relative_to(top).parts[0]
    return first.removesuffix(".py")


def imports(path: Path) -> Iterator[str]:
    """Yield every imported module, with `from robotteamsim import x` as robotteamsim.x."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno}: imports are absolute"
            if node.module == "robotteamsim":
                yield from (f"robotteamsim.{alias.name}" for alias in node.names)
            else:
                yield str(node.module)


def may_use(own: str, other: str) -> bool:
    return other == own or FLOOR_OF[other] < FLOOR_OF[own]


@pytest.mark.parametrize("path", PYTHON_FILES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_python_module_imports_only_from_lower_floors(path):
    own = part_of(path, PACKAGE)
    if own == "__init__":
        assert not [name for name in imports(path) if name.startswith("robotteamsim")]
        return
    used = {name.split(".")[1] for name in imports(path) if name.startswith("robotteamsim.")} - {"msg", "srv"}
    assert {other for other in used if not may_use(own, other)} == set()


@pytest.mark.parametrize("path", CPP_FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_cpp_file_includes_only_from_lower_floors_and_neither_ros_nor_python(path):
    top = ROOT / "include" / "robotteamsim" if path.is_relative_to(ROOT / "include") else ROOT / "src" / "cpp"
    own = part_of(path, top)
    included = re.findall(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', path.read_text(encoding="utf-8"), re.MULTILINE)
    ours = {name.split("/")[1] for name in included if name.startswith("robotteamsim/")}
    assert {other for other in ours if not may_use(own, other)} == set()
    assert [name for name in included if re.match(r"(ros/|pybind11|Python\.h|\w+_msgs/)", name)] == []


@pytest.mark.parametrize("path", PYTHON_FILES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_ros_is_imported_only_in_the_ros_shell(path):
    if part_of(path, PACKAGE) != "ros":
        assert [name for name in imports(path) if ROS.match(name) or ROS_MESSAGES.match(name)] == []


@pytest.mark.parametrize("path", PYTHON_FILES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_only_programs_for_a_terminal_print(path):
    calls = [node for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(node, ast.Call)]
    prints = [call.lineno for call in calls if isinstance(call.func, ast.Name) and call.func.id == "print"]
    assert prints == [] or part_of(path, PACKAGE) == "cli" or path.name == "teleop.py"


def test_nothing_is_random_but_by_the_named_streams_of_a_seed():
    files = [*PYTHON_FILES, *CPP_FILES, *(ROOT / "src" / "bindings").glob("*.[ch]pp")]
    found = {str(path): OTHER_CHANCE.findall(path.read_text(encoding="utf-8")) for path in files}
    assert [path for path, matches in found.items() if matches] == [str(PACKAGE / "rng.py")]


def test_every_module_below_the_ros_shell_imports_without_ros():
    names = [
        ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")
        for path in PYTHON_FILES
        if part_of(path, PACKAGE) != "ros" and path.name != "__main__.py"
    ]
    code = (
        "import importlib, sys; sys.modules['rospy'] = None; [importlib.import_module(name) for name in sys.argv[1:]]"
    )
    done = subprocess.run([sys.executable, "-c", code, *names], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
