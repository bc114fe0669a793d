"""What the layers of a drawing of a CAD program are: a table in YAML that an import guesses and the user corrects."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Literal, get_args

import numpy as np
from pydantic import Field, model_validator

from robotteamsim.errors import ScenarioError
from robotteamsim.scenario.base import SMALLEST, Model, wrong
from robotteamsim.scenario.cad_content import Content, key
from robotteamsim.scenario.image_walls import MAX_WALL_THICKNESS_M
from robotteamsim.scenario.materials import Substance
from robotteamsim.scenario.problems import checked, suggestion
from robotteamsim.scenario.yaml_text import read_mapping, shown
from robotteamsim.wording import counted, printable

WALL_THICKNESS_M = 0.1

Kind = Literal["wall", "door", "window", "ignore"]

_WORDS: tuple[tuple[str, Kind], ...] = (
    (r"anno|dim|hatch|iden|note|patt|schraff|text", "ignore"),  # such as A-WALL-PATT
    (r"door|t(ü|ue)r|porte|puerta|porta|deur", "door"),
    (r"window|glaz|glass|fenster|fen(ê|e)tre|ventana|finestr|janela|raam|vitr", "window"),
    (r"wall|wand|w(ä|ae)nde|mauer|mur|pared|muur|column|cols?(\b|_)|pillar|st(ü|ue)tze|pil", "wall"),
)
"""How words in the name of a layer begin, in some languages; the first match counts."""


class LayerRule(Model):
    """What the lines of a layer are."""

    kind: Kind = Field(description="wall; window: an obstacle of glass; door: in gaps of walls; or ignore")
    material: Substance | None = Field(
        default=None, description="of walls and windows; default: walls by their thickness, windows of 6 mm of glass"
    )
    thickness_m: float = Field(
        default=WALL_THICKNESS_M,
        ge=SMALLEST,
        le=MAX_WALL_THICKNESS_M,
        description="of lines that are no faces of a wall and have no width [m]",
    )

    @model_validator(mode="after")
    def _check(self) -> LayerRule:
        if self.kind in ("door", "ignore"):
            for name in sorted(self.model_fields_set - {"kind"}):
                raise wrong(name, f"not allowed for a layer of kind {self.kind}")
        return self


Rules = Mapping[str, LayerRule]
"""By the `key` of a layer."""


def guessed_rules(found: Content) -> dict[str, LayerRule]:
    """Return what layers are by their names; all others are ignored."""
    return {layer: LayerRule(kind=_guess(found.names[layer])) for layer in _filled(found)}


def _guess(name: str) -> Kind:
    return next(
        (kind for words, kind in _WORDS if re.search(rf"(?<![^\W\d_])({words})", name, re.IGNORECASE)), "ignore"
    )


def _filled(found: Content) -> list[str]:
    """Return the layers with any parts, in the order of their names."""
    return sorted({*(line.layer for line in found.lines), *(layer for layer, _ in found.others)})


def read_rules(path: Path, drawing: Path, found: Content) -> dict[str, LayerRule]:
    """Return what a table says; layers that it does not name are ignored.

    Args:   drawing, found: the file with the layers, and its content.
    Raises: ScenarioError: one line with file, key and what was expected.
    """
    names = {key(printable(name)): layer for layer, name in found.names.items()}
    rules: dict[str, LayerRule] = {}
    for name, values in read_mapping(path, str(path), "a table of layers").items():
        layer = names.get(key(name))
        if layer is None:
            known = suggestion(name, [printable(known) for known in found.names.values()])
            raise ScenarioError(f"{path}: {printable(name)}: {drawing} has no layer of this name{known}")
        if layer in rules:
            raise ScenarioError(f"{path}: {printable(name)}: named twice; upper and lower case do not matter")
        if not isinstance(values, dict):
            raise ScenarioError(f"{path}: {printable(name)}: {shown(values)} is not a section, such as {{kind: wall}}")
        rules[layer] = checked(LayerRule, values, place=f"{path}: {printable(name)}.")
    return rules


def table(rules: Rules, drawing: Path, found: Content) -> str:
    """Return the text of a table of rules, with the contents of each layer as a comment."""
    contents = layer_texts(found)
    substances = ", ".join(name for name in get_args(Substance) if name != "air")
    head = f"""\
# What the layers of {printable(drawing.name)} are. Correct it, and import the drawing again with --layers.
# kind: wall, window, door (at gaps between walls) or ignore. Of walls and windows also, such as
# {{kind: wall, material: brick, thickness_m: 0.24}}, the thickness of single lines, and a material:
# {substances}.
"""
    names = {layer: json.dumps(printable(found.names[layer]), ensure_ascii=False) for layer in rules}
    return head + "".join(f"{names[on]}: {{kind: {rule.kind}}}  # {contents[on]}\n" for on, rule in rules.items())


def layer_texts(found: Content) -> dict[str, str]:
    """Return what each layer contains, with the size of its lines in units of the drawing."""
    ends: dict[str, list[np.ndarray]] = {}
    for line in found.lines:
        ends.setdefault(line.layer, []).append(line.ends)
    texts = {}
    for layer in _filled(found):
        parts = [f"{number} {printable(kind)}" for (on, kind), number in sorted(found.others.items()) if on == layer]
        if layer in ends:
            width, height = np.ptp(np.array(ends[layer]), axis=(0, 1)).tolist()
            parts = [counted(len(ends[layer]), "line"), f"{width:.5g} x {height:.5g} units", *parts]
        texts[layer] = ", ".join(parts)
    return texts
