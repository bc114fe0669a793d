"""The values of a world file's properties in SI units, checked, and notes on what the scenario does not support."""

import math
from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import ValidationError

from robotteamsim.geometry import normalise_angle
from robotteamsim.scenario.base import Model
from robotteamsim.scenario.problems import problems, suggestion
from robotteamsim.stage.world_file import Entity, Place, Property

M = TypeVar("M", bound=Model)

Pose2 = tuple[float, float, float]
"""x, y, yaw [m, m, rad]."""

ASIDE_M = 1e-6
"""Values this near to 0 count as 0."""

MAX_NUMBER = 1e6
"""Limit of all lengths, angles, times and counts."""

_LENGTHS_M = {"m": 1.0, "cm": 0.01, "mm": 0.001}
_ANGLES_RAD = {"degrees": math.pi / 180.0, "radians": 1.0}

_FORMS = {"llla": "[x y z heading]", "lll": "[x y z]", "ll": "[low high]", "lfa": "[constant share angle]"}


class Values:
    """Reads properties in the file's units and records which ones were read."""

    def __init__(self, root: Entity) -> None:
        """Read the units of the world. Raises: ScenarioError: an unknown unit."""
        self._read: set[Property] = set()
        self._length_m = _LENGTHS_M[self.choice(root, "unit_length", tuple(_LENGTHS_M), "m")]
        self._angle_rad = _ANGLES_RAD[self.choice(root, "unit_angle", tuple(_ANGLES_RAD), "degrees")]

    def was_read(self, given: Property) -> bool:
        """Whether a property was read."""
        return given in self._read

    def numbers(self, entity: Entity, key: str, units: str, default: tuple[float, ...]) -> tuple[float, ...]:
        """Return numbers in SI units.

        Args:   units: one letter each: l a length, a an angle, f without unit.
                default: in SI units, if the file does not have the key.
        Raises: ScenarioError: a text, or the wrong number of values.
        """
        given = self._given(entity, key)
        if given is None:
            return default
        if len(given.values) != len(units) or any(isinstance(value, str) for value in given.values):
            form = f", {_FORMS[units]}" if units in _FORMS else ""
            wanted = f"{len(units)} numbers{form}" if len(units) > 1 else "a number"
            raise given.place.error(f"{key}: {_shown(given)} is not {wanted}")
        if any(abs(value) > MAX_NUMBER for value in given.values if not isinstance(value, str)):
            raise given.place.error(f"{key}: {_shown(given)} is beyond {MAX_NUMBER:.0f}")
        scale = {"l": self._length_m, "a": self._angle_rad, "f": 1.0}
        return tuple(float(value) * scale[unit] for value, unit in zip(given.values, units, strict=True))

    def number(self, entity: Entity, key: str, unit: str, default: float) -> float:
        """Return one number in SI units; arguments and errors as in `numbers`."""
        return self.numbers(entity, key, unit, (default,))[0]

    def whole(self, entity: Entity, key: str, default: int) -> int:
        """Return a whole number. Raises: ScenarioError."""
        value = self.number(entity, key, "f", default)
        if value != int(value):
            raise entity.error(key, f"{value:g} is not a whole number")
        return int(value)

    def text(self, entity: Entity, key: str, default: str) -> str:
        """Return a text. Raises: ScenarioError: a number."""
        given = self._given(entity, key)
        if given is None:
            return default
        if len(given.values) != 1 or not isinstance(given.values[0], str):
            raise given.place.error(f"{key}: {_shown(given)} is not a text in quotes")
        return given.values[0]

    def choice(self, entity: Entity, key: str, known: tuple[str, ...], default: str) -> str:
        """Return one of the known texts. Raises: ScenarioError."""
        value = self.text(entity, key, default)
        if value not in known:
            raise entity.error(key, f"'{value}' is not one of {', '.join(known)}{suggestion(value, known)}")
        return value

    def pose(self, entity: Entity, key: str) -> tuple[Pose2, float]:
        """Return a pose and its z; zero without the key."""
        x, y, z, heading = self.numbers(entity, key, "llla", (0.0, 0.0, 0.0, 0.0))
        return (x, y, normalise_angle(heading)), z

    def size(self, entity: Entity, default: tuple[float, ...]) -> tuple[float, ...]:
        """Return the size of a body [m]. Raises: ScenarioError: it is not above 0."""
        size = self.numbers(entity, "size", "lll", default)
        for axis, value in zip("xyz", size, strict=True):
            # A flat body is allowed: there are floor plans with a height of 0.
            if value < 0.0 or (value == 0.0 and axis != "z"):
                raise entity.error("size", f"{axis} {value:g} is not above 0")
        return size

    def _given(self, entity: Entity, key: str) -> Property | None:
        given = entity.get(key)
        if given is not None:
            self._read.add(given)
        return given


class Notes:
    """Notes for the user on a world, with file and line, and one line per file on properties without effect."""

    def __init__(self) -> None:
        self._said: dict[tuple[Place, str], None] = {}
        self._without_effect: dict[str, dict[str, set[int]]] = {}

    def say(self, place: Place, text: str) -> None:
        """Note that something is interpreted differently from Stage; repeated notes appear once."""
        self._said[(place, text)] = None

    def of(self, entity: Entity, name: str, text: str) -> None:
        """Note that a property is interpreted differently from Stage."""
        self.say(entity.place_of(name), f"{name}: {text}")

    def without_effect(self, name: str, place: Place) -> None:
        """Note a key or model without effect here."""
        self._without_effect.setdefault(place.file, {}).setdefault(name, set()).add(place.line)

    def lines(self) -> list[str]:
        """Return the notes, by file and line."""
        lines = [f"{place}: {text}" for place, text in sorted(self._said)]
        for file, names in self._without_effect.items():
            shown = [f"{name} (line {', '.join(map(str, sorted(at)))})" for name, at in names.items()]
            lines.append(f"{file}: no effect here: {', '.join(shown)}")
        return lines


def compose(first: Pose2, second: Pose2) -> Pose2:
    """Return the pose `second`, given in the frame of `first`, in the frame in which `first` is given."""
    (x0, y0, yaw0), (x1, y1, yaw1) = first, second
    cos, sin = math.cos(yaw0), math.sin(yaw0)
    return x0 + cos * x1 - sin * y1, y0 + sin * x1 + cos * y1, normalise_angle(yaw0 + yaw1)


def tidy(value: float) -> float:
    """Return a number without the last digits, which come from unit conversion."""
    return round(value, 9) + 0.0


def checked(model: type[M], values: Mapping[str, Any], sources: Mapping[str, tuple[Entity, str]]) -> M:
    """Return a section of the scenario.

    Args:   sources: entity and property behind each key.
    Raises: ScenarioError: a value is out of range; names the property and its line.
    """
    try:
        return model.model_validate(dict(values))
    except ValidationError as error:
        problem = problems(error, model)[0]
        entity, key = sources.get(problem.key) or next(iter(sources.values()))
        raise entity.error(key, str(problem)) from None


def _shown(given: Property) -> str:
    values = [f"'{value}'" if isinstance(value, str) else f"{value:g}" for value in given.values]
    return f"[{' '.join(values)}]" if len(values) != 1 else values[0]
