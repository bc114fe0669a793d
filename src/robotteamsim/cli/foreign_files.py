"""Names files of other simulators: what they are, and which command reads them."""

import re
from collections.abc import Iterable
from pathlib import Path

from robotteamsim.errors import ScenarioError
from robotteamsim.formats import importers
from robotteamsim.scenario.yaml_text import is_file, read_text

_SIGNS = (
    (r"\A\s*(?=<).*?<sdf[\s>]", "a world of Gazebo (SDF)"),
    (r"\A\s*(?=<).*?<mvsim_world[\s>]", "a world of MVSim"),
    (r"\A(?=.*^world:)(?=.*^(robot|obstacle):)", "a world of IR-SIM"),
)
"""What only such a file has: an element (SDF 1.6, mvsim 0.10), or keys (ir-sim 2.11)."""


def foreign_file(words: Iterable[str]) -> str | None:
    """Return a line on the first of a command's words that names a file of another simulator; None: there is none."""
    for word in words:
        name = word.rpartition("=")[2] if word.startswith("-") else word
        if not is_file(Path(name)):
            continue
        try:
            text = read_text(Path(name), name, errors="replace")
        except ScenarioError:
            continue
        if noun := next((importer.noun for importer in importers().values() if importer.recognises(text)), None):
            return None if "import" in words else f"{name} is {noun}: use plan import"
        what = next((what for sign, what in _SIGNS if re.search(sign, text, re.MULTILINE | re.DOTALL)), None)
        if what is not None:
            return f"{name} is {what}, which no command reads; docs/own_building.md shows how to draw its floor plan"
    return None
