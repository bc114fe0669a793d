"""Materials of IFC as layers of substances, by their names in English."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from pydantic import ValidationError

from robotteamsim.scenario.base import MAX_NAME_CHARACTERS
from robotteamsim.scenario.materials import GLASS, Layer, Material, Substance
from robotteamsim.wording import counted, printable

_WORDS: tuple[tuple[str, Substance], ...] = (
    # Studs, joists and insulation count as air; "Metal - Stud Layer" is no sheet of metal.
    (r"stud|joist|rafter|\bair\b|cavity|insulat|wool|foam|\beps\b|\bxps\b|membrane|vapou?r|damp|\bfelt\b", "air"),
    # Hollow. 0.19 m of brick, of concrete and of half as much concrete lose 4.3, 12.4 and 6.2 dB at 2.4 GHz [ITU-R
    # P.2040-3, Table 3]: brick is nearer.
    (r"concrete (masonry|block)|masonry - concrete|block ?work|(cinder|breeze) ?block|\bcmu\b|aerated", "brick"),
    (r"plaster|gypsum|dry ?wall|\bgyp\b", "plasterboard"),
    (r"ceiling", "ceiling_board"),
    (r"plywood", "plywood"),
    (r"chip ?board|particle ?board|\bosb\b|\bmdf\b", "chipboard"),
    (r"concrete|cement|screed|mortar", "concrete"),
    (r"brick|masonry", "brick"),
    (r"marble|stone|granite|terrazzo|ceramic|\btiles?\b", "marble"),
    (r"glass|glaz", "glass"),
    (r"wood|timber|lumber", "wood"),
    (r"metal|steel|alumini?um|\biron\b|copper|zinc", "metal"),
)
"""Parts of names, the first match counts."""

_MOST_LISTED = 10


def substance_of(name: str) -> Substance | None:
    """Return the substance that a material's name suggests."""
    return next((substance for words, substance in _WORDS if re.search(words, name, re.IGNORECASE)), None)


class IfcMaterials:
    """The materials of the elements that were asked for, and what was guessed."""

    def __init__(self, scale_m: float) -> None:
        """Know none yet. Args: scale_m: of lengths in the file."""
        self._scale_m = scale_m
        self._materials: dict[str, Material] = {}
        self._guessed: dict[str, Substance] = {}
        self._problems: Counter[str] = Counter()
        self._num_glass = 0

    def used_by(self, elements: Iterable[Mapping[str, Any]]) -> tuple[Material, ...]:
        """Return the materials of some walls and blocks, by the first use. Args: elements: their keys in a plan."""
        names = dict.fromkeys(element["material"] for element in elements)
        return tuple(self._materials[name] for name in names if name is not None)

    def of(self, element: Any, thickness_m: float, *, is_glazed: bool = False) -> str | None:
        """Return the name of an element's material; None: it is unknown.

        Args: is_glazed: it is the panel of a curtain wall, of glass unless its material is known.
        """
        from ifcopenshell.util.element import get_material

        definition = get_material(element, should_skip_usage=True)
        problems = Counter[str]()
        layers = tuple(self._layers(definition, thickness_m, problems)) if definition else ()
        if not definition:
            problems["without a material"] += 1
        if not problems and layers:
            name = _name(definition)
            try:
                return self._add(name, Material(name=name[:MAX_NAME_CHARACTERS], layers=layers))
            except ValidationError:  # more layers, or thicker ones, than a plan has
                problems[f"'{name}' has {counted(len(layers), 'layer')} that a plan cannot have"] += 1
        if is_glazed:
            self._num_glass += 1
            return self.glass()
        self._problems.update(dict.fromkeys(problems, 1))
        return None

    def glass(self) -> str:
        """Return the name of the glass of windows."""
        return self._add(GLASS.name, GLASS)

    def _add(self, name: str, material: Material) -> str:
        """Add a material, under another name if this one is taken by other layers; return its name."""
        count = 1
        while self._materials.setdefault(material.name, material).layers != material.layers:
            count += 1
            end = f" {count}"
            material = material.model_copy(update={"name": name[: MAX_NAME_CHARACTERS - len(end)] + end})
        return material.name

    def _layers(self, definition: Any, thickness_m: float, problems: Counter[str]) -> Iterator[Layer]:
        """Yield layers; count in `problems` why they are not known. Args: thickness_m: of the whole wall."""
        parts = _parts(definition)
        if len(parts) > 1 and any(layer_thickness is None for _, layer_thickness in parts):
            problems["whose layers have no thickness"] += 1
            return
        for name, layer_thickness in parts:
            layer_m = thickness_m if layer_thickness is None else self._scale_m * layer_thickness
            if not layer_m > 0.0:  # membranes
                continue
            if (found := substance_of(name)) is None:
                problems[f"of '{name}'" if name else "with a layer without a material"] += 1
                continue
            if found.replace("_", " ") not in name.lower() or re.search(r"block", name, re.IGNORECASE):
                self._guessed[name] = found
            try:
                yield Layer(of=found, thickness_m=round(layer_m, 6))
            except ValidationError:
                problems[f"'{name}' is {layer_m:g} m thick"] += 1

    def notes(self) -> Iterator[str]:
        """Yield what was guessed, and what is unknown."""
        if self._guessed:
            yield "materials by their names: " + _some(
                [f"'{name}' is taken as {found}" for name, found in self._guessed.items()]
            )
        if self._num_glass:
            thickness_mm = 1e3 * GLASS.layers[0].thickness_m
            yield f"{counted(self._num_glass, 'panel')} of curtain walls: taken as {thickness_mm:g} mm of glass"
        if self._problems:
            known = [f"{number} {problem}" for problem, number in self._problems.items()]
            yield f"walls and columns whose loss follows from their thickness: {_some(known)}"


def _of_layer(layer: Any) -> str:
    """Return the name of a layer's material; "air" for an air gap, which says so by IsVentilated [IFC 4]; "": none."""
    if layer.Material is None:
        return "air" if layer.IsVentilated in (True, "UNKNOWN") else ""
    return _text(layer.Material.Name)


def _text(name: str | None) -> str:
    return printable((name or "").strip())


def _parts(definition: Any) -> list[tuple[str, float | None]]:
    """Return the names of the materials of a definition, and their thickness in units of the file or None."""
    if definition.is_a("IfcMaterialLayerSet"):
        return [(_of_layer(layer), layer.LayerThickness) for layer in definition.MaterialLayers]
    if definition.is_a("IfcMaterialLayer"):
        return [(_of_layer(definition), definition.LayerThickness)]
    if definition.is_a("IfcMaterialList"):
        return [(_text(material.Name), None) for material in definition.Materials]
    if definition.is_a("IfcMaterialConstituentSet"):
        return [(_text(constituent.Material.Name), None) for constituent in definition.MaterialConstituents or ()]
    if definition.is_a("IfcMaterialProfileSet"):
        return [(_text(getattr(profile.Material, "Name", None)), None) for profile in definition.MaterialProfiles]
    return [(_text(getattr(definition, "Name", None)), None)]


def _name(definition: Any) -> str:
    """Return the name of a material, a layer set, or of what they contain."""
    for attribute in ("LayerSetName", "Name"):
        if text := _text(getattr(definition, attribute, None)):
            return text
    return ", ".join(filter(None, (name for name, _ in _parts(definition)))) or "layers"


def _some(texts: list[str]) -> str:
    """Return texts in one line; of many, the first and how many more there are."""
    more = [f"{len(texts) - _MOST_LISTED} more"] if len(texts) > _MOST_LISTED else []
    return ", ".join([*texts[:_MOST_LISTED], *more])
