"""Build the website of docs/ without a network: python docs/build_site.py FOLDER

It opens with a playable mission, and contains the pages of docs/, the executed notebook, and a reference that is
generated from the schema of scenarios and from docstrings.
"""

import html
import importlib
import inspect
import json
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from sphinx.cmd.build import main as sphinx_build

from robotteamsim.scenario import json_schema, load
from robotteamsim.view.html import mission_page
from robotteamsim.view.recorder import record_mission

DOCS = Path(__file__).parent
ROOT = DOCS.parent
STUDIES = (ROOT / "study" / "README.md", *sorted(ROOT.glob("study/*/README.md")), ROOT / "bench" / "README.md")

SECTIONS = {
    "Tutorials": (
        "README",
        "install",
        "tutorial",
        "notebook",
        "tutorial_controller",
        "tutorial_gazebo",
        "classroom",
        "exercises",
        "exercise_answers",
    ),
    "How-to guides": (
        "own_building",
        "own_sensor",
        "own_parts",
        "python",
        "viewer",
        "experiments",
        "benchmark",
        "learning",
        "stage",
        "gazebo",
        "gazebo_missions",
    ),
    "Reference": (
        "what_a_controller_sees",
        "formats_of_buildings",
        "scenario_keys",
        "python_api",
        "ros_api",
        "ros2",
        "ros_messages",
        "CHANGELOG",
    ),
    "Explanation": (
        "world",
        "rescue",
        "fire",
        "propagation",
        "network",
        "swarm",
        "search",
        "unknown_buildings",
        "testing",
        "reliability",
        "SECURITY",
        "CONTRIBUTING",
    ),
    "Studies": tuple(str(page.relative_to(ROOT).with_suffix("")) for page in STUDIES),
}
"""The pages of the website by kind (https://diataxis.fr); each page of docs/ is in one section."""

PACKAGES = ("notebook", "scenario", "simulation", "recording", "interface", "propagation", "swarm", "campaign")
"""Packages for users, whose docstrings are the reference of Python."""

_OF_ROOT = ("README", "CHANGELOG", "SECURITY", "CONTRIBUTING")
_MISSION = ("garage_sar", ("run.seed=7", "voice.noise_db=20"))

_INDEX = """# robotteamsim

Teams of mobile robots in search and rescue: one mission, headless and in ROS 1. This one was simulated when these pages
were built. Press the triangle, or drag the slider; click on a robot to follow it.

<iframe src="mission.html#t=60" title="a mission in the garage"
 style="width:100%;height:600px;border:0;border-radius:8px"></iframe>

[How to install it](README.md)
"""


def main() -> int:
    """Build the website; return the exit status of Sphinx."""
    target = Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder)
        write_sources(source)
        shutil.rmtree(target, ignore_errors=True)
        return sphinx_build(
            ["-q", "-W", "--keep-going", "-b", "html", "-d", str(source / ".doctrees"), str(source), str(target)]
        )


def write_sources(folder: Path) -> None:
    """Write everything that Sphinx reads."""
    unlisted = {page.stem for page in DOCS.glob("*.md")} - {name for names in SECTIONS.values() for name in names}
    if unlisted:
        raise SystemExit(f"docs/{sorted(unlisted)[0]}.md: is in no section; expected in SECTIONS of docs/build_site.py")
    for page in DOCS.glob("*.md"):
        (folder / page.name).write_text(page.read_text(encoding="utf-8").replace("](../", "]("), encoding="utf-8")
    for name in _OF_ROOT:
        text = (ROOT / f"{name}.md").read_text(encoding="utf-8")
        # Also src="docs/images/..." in HTML.
        (folder / f"{name}.md").write_text(re.sub(r'(\]\(|src="|href=")docs/', r"\1", text), encoding="utf-8")
    shutil.copytree(DOCS / "images", folder / "images")
    shutil.copytree(DOCS / "images", folder / "extra" / "images")
    shutil.copytree(DOCS / "exercises", folder / "exercises")
    shutil.copytree(ROOT / "examples", folder / "examples")
    shutil.copytree(ROOT / "study", folder / "study", ignore=shutil.ignore_patterns("*.py", "__pycache__", "data"))
    (folder / "bench").mkdir()
    for page in STUDIES:
        text = page.read_text(encoding="utf-8").replace("../docs/", "../")
        (folder / page.relative_to(ROOT)).write_text(text, encoding="utf-8")
    report = Path("study", "dissertation", "report")
    shutil.copytree(ROOT / report, folder / "extra" / report)
    shutil.copy(DOCS / "notebook.ipynb", folder / "extra")
    shutil.copy(DOCS / "site" / "conf.py", folder)
    (folder / "notebook.md").write_text(notebook_page(DOCS / "notebook.ipynb"), encoding="utf-8")
    (folder / "scenario_keys.md").write_text(keys_page(json_schema()), encoding="utf-8")
    (folder / "ros_messages.md").write_text(messages_page(ROOT), encoding="utf-8")
    (folder / "python_api.rst").write_text(api_page(), encoding="utf-8")
    name, overrides = _MISSION
    recording = record_mission(load(name, overrides))[0]
    (folder / "extra" / "mission.html").write_text(mission_page([recording], recording.title), encoding="utf-8")
    (folder / "index.md").write_text(_INDEX + "".join(map(_contents, SECTIONS)), encoding="utf-8")


def _contents(section: str) -> str:
    titles = {"README": "First missions <README>", "install": "Installation <install>"}
    pages = [titles.get(name, name) for name in SECTIONS[section]]
    return "\n".join(("", ":::{toctree}", ":maxdepth: 1", f":caption: {section}", "", *pages, ":::", ""))


def notebook_page(path: Path) -> str:
    """Return an executed notebook as Markdown with its outputs."""
    parts = []
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        text = "".join(cell["source"])
        parts.append(text if cell["cell_type"] == "markdown" else f"```python\n{text}\n```")
        parts += map(_output, cell.get("outputs", ()))
    return "\n\n".join(parts) + "\n"


def _output(output: dict[str, Any]) -> str:
    rich = "".join(output.get("data", {}).get("text/html", ""))
    if rich:
        unbroken = re.sub(r"\n\s*\n", "\n", rich)  # A blank line would end the HTML block.
        return f"<div>{unbroken}</div>"
    return f"<pre>{html.escape(''.join(output.get('text', '')))}</pre>"


def keys_page(schema: dict[str, Any]) -> str:
    """Return the reference of all keys of a scenario."""
    lines = ["# Scenario keys", "", "Generated from `robotteamsim scenario schema`.", ""]
    lines += ["## Scenario", "", *_table(schema)]
    for name, model in sorted(schema["$defs"].items()):
        if "properties" in model:
            lines += ["", f"## {name}", "", model.get("description", ""), "", *_table(model)]
    return "\n".join(lines) + "\n"


def _table(model: dict[str, Any]) -> Iterator[str]:
    yield "| key | type | default | meaning |"
    yield "|---|---|---|---|"
    for key, value in model["properties"].items():
        default = "required" if key in model.get("required", ()) else ""
        if "default" in value and not isinstance(value["default"], dict):  # A section's defaults are its own keys'.
            default = f"`{json.dumps(value['default'])}`"
        meaning = value.get("description", "").replace("|", "\\|")
        yield f"| `{key}` | {_type(value)} | {default} | {meaning}{_limits(value)} |"


def _type(value: dict[str, Any]) -> str:
    if "$ref" in value:
        name = value["$ref"].rpartition("/")[2]
        return f"[{name}](#{name.lower()})"
    if "enum" in value:
        return ", ".join(f"`{one}`" for one in value["enum"])
    parts = value.get("anyOf") or value.get("oneOf")
    if parts:
        return " or ".join(map(_type, parts))
    if value.get("type") == "array" and "items" in value:
        return f"list of {_type(value['items'])}"
    return str(value.get("type", "any"))


def _limits(value: dict[str, Any]) -> str:
    signs = {"minimum": "\u2265", "exclusiveMinimum": ">", "maximum": "\u2264", "exclusiveMaximum": "<"}
    limits = [f"{sign} {value[name]:g}" for name, sign in signs.items() if name in value]
    return f" ({', '.join(limits)})" if limits else ""


def messages_page(root: Path) -> str:
    """Return the reference of all messages and services, from their files."""
    lines = ["# ROS messages and services", "", "Generated from the files in `msg` and `srv`."]
    for path in (*sorted(root.glob("msg/*.msg")), *sorted(root.glob("srv/*.srv"))):
        about, attributes = message_attributes(path.read_text(encoding="utf-8"))
        lines += ["", f"## {path.stem}", "", about, "", "| attribute | type | meaning |", "|---|---|---|"]
        lines += (f"| `{name}` | `{kind}` | {meaning} |" for kind, name, meaning in attributes)
    return "\n".join(lines) + "\n"


def message_attributes(text: str) -> tuple[str, list[tuple[str, str, str]]]:
    """Return the first comment of a message, and type, name and comment of each attribute; answers have an arrow."""
    about, attributes, arrow = [], [], ""
    for line in text.splitlines():
        declared, _, comment = (part.strip() for part in line.partition("#"))
        if declared == "---":
            arrow = "\N{RIGHTWARDS ARROW} "
        elif declared:
            kind, _, name = declared.partition(" ")
            attributes.append((kind, f"{arrow}{name}", comment.replace("|", "\\|")))
        elif attributes:
            attributes[-1] = (*attributes[-1][:2], f"{attributes[-1][2]} {comment}")
        else:
            about.append(comment)
    return " ".join(about), attributes


def api_page() -> str:
    """Return the reference of Python, as Sphinx's autodoc directives."""
    lines, described = ["Python", "======", "", "Generated from docstrings.", ""], set()
    for module in map(importlib.import_module, ("robotteamsim", *(f"robotteamsim.{name}" for name in PACKAGES))):
        early = set(vars(module))
        # One object is described once, in the first package that offers it.
        names = [name for name in module.__all__ if id(getattr(module, name)) not in described]
        own = [name for name in names if name in early]
        late = [getattr(module, name) for name in names if name not in early]  # Imported on first use.
        lines += [module.__name__, "-" * len(module.__name__), "", f".. automodule:: {module.__name__}"]
        lines += [f"   :members: {', '.join(own)}", "   :undoc-members:", ""] if own else [""]
        for value in filter(inspect.isroutine, late):
            lines += [f".. autofunction:: {value.__module__}.{value.__name__}", ""]
        for kind in filter(inspect.isclass, late):
            lines += [f".. autoclass:: {kind.__module__}.{kind.__name__}", "   :members:", "   :undoc-members:", ""]
        values = (getattr(module, name) for name in names)
        described |= {id(value) for value in values if inspect.isroutine(value) or inspect.isclass(value)}
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
