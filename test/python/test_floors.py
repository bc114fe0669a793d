"""Modules import only from floors below their own; ROS stays in the ROS shell, and chance in named streams."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "src" / "robotteamsim"

FLOORS = (
    # base is C++
    ("base", "ending", "errors", "extras", "geometry", "message_parts", "palette", "rng", "user_files", "wording"),
    ("arguments", "cache", "map_import", "own_parts"),
    ("scenario", "plan"),  # C++ calls it plan
    ("world", "propagation", "hazards"),
    ("setup", "state"),
    ("sensing", "network", "formats"),
    ("swarm", "stage", "gazebo"),
    ("interface",),
    ("maps",),
    ("control",),
    ("mission",),
    ("simulation",),
    ("recording",),
    ("campaign",),
    ("analysis",),
    ("view",),
    ("nodes",),
    ("cli", "learning", "notebook", "ros", "ros2"),
    ("__main__", "testing"),  # runs cli; checks learning
)
FLOOR_OF = {part: floor for floor, parts in enumerate(FLOORS) for part in parts}

SHELLS = ("ros", "ros2")
ROS = re.compile(
    r"(rclpy|rcl_interfaces|rospy|roslib|roslaunch|rosgraph|rospkg|rosbag|genpy|tf|tf2_ros|\w+_(msgs|srvs))(\.|$)"
)
ROS_MESSAGES = re.compile(r"robotteamsim\.(msg|srv|_ros_publisher)(\.|$)")
NOT_OF_THE_LIBRARY = re.compile(r"(ros/|pybind11|nanobind|Python\.h|numpy/|\w+_msgs/)")

OTHER_CHANCE = re.compile(
    r"random_device|mt19937|minstd_rand|\bs?rand\(|default_rng|RandomState|np\.random\.(?!Generator\b)"
    r"|\b(?:import|from) random\b|\bsecrets\b|urandom|\buuid"
)

PYTHON_FILES = sorted(PACKAGE.rglob("*.py"))
CPP_FILES = sorted(path for top in ("include", "src/cpp") for path in (ROOT / top).rglob("*.[ch]pp"))
BINDINGS = sorted((ROOT / "src" / "bindings").glob("*.[ch]pp"))


def part_of(path: Path) -> str:
    """Return the package, or the module of the ground floor, that a file belongs to."""
    tops = PACKAGE, ROOT / "include" / "robotteamsim", ROOT / "src" / "cpp"
    top = next(top for top in tops if path.is_relative_to(top))
    return path.relative_to(top).parts[0].removesuffix(".py")


def nodes(path: Path) -> Iterator[ast.AST]:
    return ast.walk(ast.parse(path.read_text(encoding="utf-8")))


def imports(path: Path) -> Iterator[str]:
    """Yield every imported module, with `from robotteamsim import x` as robotteamsim.x."""
    for node in nodes(path):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno}: imports are absolute"
            if node.module in ("robotteamsim", "robotteamsim._core"):
                yield from (f"{node.module}.{alias.name}" for alias in node.names)
            else:
                yield str(node.module)


def core_floors(path: Path) -> Iterator[str]:
    """Yield the floors of the C++ library that a module uses: x of `_core.x` and of `robotteamsim._core.x`."""
    for node in nodes(path):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "_core":
            yield node.attr
    yield from (name.split(".")[2] for name in imports(path) if name.startswith("robotteamsim._core."))


def used_floors(path: Path) -> set[str]:
    ours = {name.split(".")[1] for name in imports(path) if name.startswith("robotteamsim.")}
    core = {name for name in core_floors(path) if not name.startswith("__")}
    return (ours - {"_core", "_ros_publisher", "msg", "srv"}) | core


def included(path: Path) -> list[str]:
    text = path.read_text(encoding="utf-8")
    return re.findall(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', text, re.MULTILINE)


def may_use(own: str, other: str) -> bool:
    return other == own or FLOOR_OF[other] < FLOOR_OF[own]


@pytest.mark.slow
def test_python_modules_import_only_from_lower_floors_the_library_included():
    offenders = [
        f"{path.relative_to(ROOT)} uses {other}"
        for path in PYTHON_FILES
        for other in sorted(used_floors(path))
        if path != PACKAGE / "__init__.py" and not may_use(part_of(path), other)
    ]
    assert offenders == []


def test_cpp_files_include_only_from_lower_floors():
    offenders = [
        f"{path.relative_to(ROOT)} includes {name}"
        for path in CPP_FILES
        for name in included(path)
        if name.startswith("robotteamsim/") and not may_use(part_of(path), name.split("/")[1])
    ]
    assert offenders == []


def test_bindings_of_a_floor_include_only_it_and_lower_floors():
    offenders = [
        f"{path.relative_to(ROOT)} includes {name}"
        for path in BINDINGS
        for name in included(path)
        if path.stem.startswith("bind_")
        and name.startswith("robotteamsim/")
        and not may_use(path.stem.removeprefix("bind_"), name.split("/")[1])
    ]
    assert offenders == []


def test_each_binding_has_all_type_casters():
    # Compiled together, a source gets the casters of its neighbours: only a build without unity misses one.
    casters = re.compile(r"nanobind/(stl|eigen)/")
    own = [path.name for path in BINDINGS if path.name != "casters.hpp" and any(map(casters.match, included(path)))]
    assert own == []
    without = [p.name for p in BINDINGS if p.name.startswith("bind_") and "casters.hpp" not in included(p)]
    assert without == []
    assert any(map(casters.match, included(ROOT / "src" / "bindings" / "casters.hpp")))


def test_cpp_library_knows_neither_ros_nor_python():
    offenders = [
        f"{path.relative_to(ROOT)} includes {name}"
        for path in CPP_FILES
        for name in included(path)
        if NOT_OF_THE_LIBRARY.match(name)
    ]
    assert offenders == []


@pytest.mark.slow
def test_ros_is_imported_only_in_its_shells():
    offenders = [
        f"{path.relative_to(ROOT)} imports {name}"
        for path in PYTHON_FILES
        for name in imports(path)
        if part_of(path) not in SHELLS and (ROS.match(name) or ROS_MESSAGES.match(name))
    ]
    assert offenders == []


@pytest.mark.slow
def test_only_programs_for_a_terminal_print():
    offenders = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for path in PYTHON_FILES
        for node in nodes(path)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print"
        if part_of(path) != "cli" and path.name != "teleop.py"
    ]
    assert offenders == []


def test_nothing_is_random_but_by_the_named_streams_of_a_seed():
    files = [*PYTHON_FILES, *CPP_FILES, *BINDINGS]
    found = {str(path): OTHER_CHANCE.findall(path.read_text(encoding="utf-8")) for path in files}
    # The token of an address must not follow from a seed, and no mission depends on it.
    tokens = str(PACKAGE / "view" / "server.py")
    assert set(found.pop(tokens)) == {"secrets"}
    assert [path for path, matches in found.items() if matches] == [str(PACKAGE / "rng.py")]


@pytest.mark.slow
def test_every_module_below_the_shells_of_ros_imports_without_ros():
    names = [
        ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")
        for path in PYTHON_FILES
        if part_of(path) not in SHELLS and path.name != "__main__.py"
        if path.name != "torchrl_env.py" or find_spec("torchrl")  # its class derives from one of an optional package
    ]
    code = (
        "import importlib, sys; sys.modules['rospy'] = None; [importlib.import_module(name) for name in sys.argv[1:]]"
    )
    done = subprocess.run([sys.executable, "-c", code, *names], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_controllers_know_of_the_building_only_what_their_map_has():
    # Vertices of a patrol are the mission's: whoever patrols is given them.
    files = [path for path in PYTHON_FILES if part_of(path) == "control" and path.name != "patrol_graph.py"]
    read = [
        f"{path.relative_to(ROOT)}:{node.lineno}"
        for path in files
        for node in nodes(path)
        if isinstance(node, ast.Attribute) and node.attr == "building"
    ]
    assert read == []
