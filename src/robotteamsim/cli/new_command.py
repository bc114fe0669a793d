"""`robotteamsim new`: write a scenario, a controller, a package, exercises or a layout of Foxglove to start from."""

import argparse
import keyword
import re
import shutil
from importlib.util import find_spec
from pathlib import Path

import yaml

from robotteamsim.cli.parser import Parser, UsageError
from robotteamsim.recording.files import make_folder, write_atomically
from robotteamsim.scenario.controllers import ALGORITHMS
from robotteamsim.scenario.shipped import scenario_names, share_roots
from robotteamsim.scenario.yaml_text import shown

EPILOG = """\
examples:
  robotteamsim new scenario house          house.yaml and house_plan.yaml
  robotteamsim new controller wanderer     wanderer.py with the class Wanderer
  robotteamsim new package wanderer        wanderer/ with wanderer.py for pip install, and my_node.py for catkin_make
  robotteamsim new exercises               exercises/ with the files of docs/exercises.md
  robotteamsim new layout                  layout.json: panels for Foxglove and Lichtblick"""

_FILES = {
    "scenario": {
        "scenario/my_scenario.yaml": "my_scenario.yaml",
        "scenario/my_scenario_plan.yaml": "my_scenario_plan.yaml",
    },
    "controller": {"controller/my_controller.py": "my_controller.py"},
    "package": {
        "controller/pyproject.toml": "my_controller/pyproject.toml",
        "controller/my_controller.py": "my_controller/my_controller.py",
        "controller/my_node.py": "my_controller/my_node.py",
        "package/package.xml": "my_controller/package.xml",
        "package/CMakeLists.txt": "my_controller/CMakeLists.txt",
        "package/launch/my_controller.launch": "my_controller/launch/my_controller.launch",
    },
    "exercises": {
        f"exercises/{file}": f"my_exercises/{file}"
        for file in (
            *("radio_range.py", "doors.py", "noise.yaml", "noise.py"),
            *("wall_follower.py", "failure.yaml", "presets.py"),
        )
    },
    "layout": {"layout/my_layout.json": "my_layout.json"},
}
"""Templates by kind, and the names of the files that are made of them."""
_NEXT = {
    "scenario": "robotteamsim run {name}.yaml",
    "controller": "PYTHONPATH=$PWD:$PYTHONPATH robotteamsim run tutorial_arena --set control.algorithm={name}:{title}",
    "package": "pip install ./{name} && robotteamsim run tutorial_arena --set control.algorithm={name}\n"
    "or, with {name}/ in the src/ of a catkin workspace: catkin_make && source devel/setup.bash && "
    "roslaunch {name} {name}.launch",
    "exercises": "cd {name} && python3 radio_range.py  (docs/exercises.md)",
    "layout": "robotteamsim run garage_sar --mcap mission.mcap, and open both files in Foxglove or Lichtblick",
}


def add_to(parser: Parser) -> None:
    """Describe the command to its parser."""
    parser.add_argument("kind", choices=tuple(_FILES), help="what to write")
    parser.add_argument("name", metavar="NAME", nargs="?", help="lower-case letters, digits and _; default: the kind")
    parser.set_defaults(command=run)


def run(options: argparse.Namespace) -> None:
    """Write a template in the current folder. Raises: UsageError: the name is invalid, or a file exists."""
    name = options.kind if options.name is None else options.name
    if not re.fullmatch(r"[a-z][a-z0-9_]{0,63}", name):
        expected = "expected at most 64 lower-case letters, digits and _, such as my_house"
        raise UsageError(f"NAME: {shown(name)} is not valid; {expected}")
    if yaml.safe_load(name) != name:  # true, no, null
        raise UsageError(f"NAME: '{name}' is not text in YAML; expected another name")
    title = "".join(word.capitalize() for word in name.split("_"))
    if (options.kind == "scenario" and name in scenario_names()) or (
        options.kind in ("controller", "package")
        and (keyword.iskeyword(name) or keyword.iskeyword(title) or name in ALGORITHMS or find_spec(name) is not None)
    ):
        expected = f"expected a new name, such as my_{name}"
        raise UsageError(f"NAME: '{name}' is the name of something else in Python or robotteamsim; {expected}")
    templates = {Path(_renamed(path, name, title)): _template(file) for file, path in _FILES[options.kind].items()}
    tops = list(dict.fromkeys(Path(path.parts[0]) for path in templates))
    for path in tops:
        if path.exists() or path.is_symlink():
            raise UsageError(f"{path}: exists already; expected a new name")
    try:
        for path, template in templates.items():
            make_folder(path.parent)
            write_atomically(path, _renamed(template.read_text(encoding="utf-8"), name, title))
            path.chmod(template.stat().st_mode & 0o777)  # nodes can be executed
    except BaseException:
        for path in tops:
            shutil.rmtree(path) if path.is_dir() else path.unlink(missing_ok=True)
        raise
    print(*templates, sep="\n")
    print(f"next: {_NEXT[options.kind].format(name=name, title=title)}")


def _template(file: str) -> Path:
    (first, *_) = (root for root in share_roots() if (root / "templates" / file).is_file())
    return first / "templates" / file


def _renamed(text: str, name: str, title: str) -> str:
    """Return a template's text with the user's names in place of its own."""
    own = {"my-controller": name.replace("_", "-"), "MyController": title}
    names = r"my-controller|MyController|my_(?:scenario|controller|exercises|layout)|^mine(?= = )"
    return re.sub(names, lambda found: own.get(found[0], name), text, flags=re.MULTILINE)
