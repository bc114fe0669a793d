"""The values of a world file's properties in SI units, and notes on what becomes different in the scenario."""

import contextlib
import math
import re
from collections.abc import Iterator, Mapping
from typing import Any, NoReturn, TypeVar

from pydantic import ValidationError

from robotteamsim.errors import PlacementError, ScenarioError
from robotteamsim.geometry import normalise_angle
from robotteamsim.scenario.base import Model
from robotteamsim.scenario.problems import problems, suggestion
from robotteamsim.stage.world_file import Entity, Place, Property, Value
from robotteamsim.wording import counted

M = TypeVar("M", bound=Model)

Pose2 = tuple[float, float, float]
"""x, y, yaw [m, m, rad]."""

ASIDE_M = 1e-6
"""Values this near to 0 count as 0."""

THIN_M = 0.01
"""Thickness of what is a line in Stage: the walls of `boundary 1`, and bodies without an area."""

MAX_NUMBER = 1e6
"""Limit of all lengths, angles, times and counts."""

_LENGTHS_M = {"m": 1.0, "cm": 0.01, "mm": 0.001}
_ANGLES_RAD = {"degrees": math.pi / 180.0, "radians": 1.0}

_FORMS = {"llla": "[x y z heading]", "lll": "[x y z]", "ll": "[low high]", "lfa": "[constant share angle]"}

_LIMITS = {"greater_than": "gt", "greater_than_equal": "ge", "less_than_equal": "le"}
"""Pydantic's errors of numbers out of range, with the name of the limit."""


class Notes:
    """Notes for the user on a world, with file and line, one line per file on what has no effect, and refusals."""

    def __init__(self) -> None:
        self._said: dict[tuple[Place, str], None] = {}
        self._without_effect: dict[str, dict[str, set[int]]] = {}
        self._refused: list[ScenarioError] = []

    def say(self, place: Place, text: str) -> None:
        """Note that something is interpreted differently from Stage; repeated notes appear once."""
        self._said[(place, text)] = None

    def of(self, entity: Entity, name: str, text: str) -> None:
        """Note that a property is interpreted differently from Stage."""
        self.say(entity.place_of(name), f"{name}: {text}")

    def without_effect(self, name: str, place: Place) -> None:
        """Note a key or model without effect here."""
        self._without_effect.setdefault(place.file, {}).setdefault(name, set()).add(place.line)

    def refuse(self, error: ScenarioError) -> None:
        """Keep a refusal until all of the file are known."""
        if str(error) not in map(str, self._refused):
            self._refused.append(error)

    @contextlib.contextmanager
    def refusals(self) -> Iterator[None]:
        """Keep the refusal that the block raises, and go on after it."""
        try:
            yield
        except ScenarioError as error:
            self.refuse(error)

    def raise_refusals(self) -> None:
        """Raise ScenarioError: the first refusal, the others as its notes; PlacementError if all are of that kind."""
        if self._refused:
            kind = (
                PlacementError if all(isinstance(error, PlacementError) for error in self._refused) else ScenarioError
            )
            raised = kind(str(self._refused[0]))
            for error in self._refused[1:]:
                raised.add_note(str(error))
            raise raised

    def lines(self) -> list[str]:
        """Return the notes, by file and line, equal ones of one file in one line."""
        places: dict[tuple[str, str], list[Place]] = {}
        for place, text in sorted(self._said):
            places.setdefault((place.file, text), []).append(place)
        lines = [
            f"{at[0]}: {text}" + (f" (and {counted(len(at) - 1, 'other line')})" if len(at) > 1 else "")
            for (_, text), at in places.items()
        ]
        for file, names in self._without_effect.items():
            shown = [f"{name} (line {', '.join(map(str, sorted(at)))})" for name, at in names.items()]
            lines.append(f"{file}: no effect here: {', '.join(shown)}")
        return lines

    def checked(self, model: type[M], values: Mapping[str, Any], sources: Mapping[str, tuple[Entity, str]]) -> M:
        """Return a section of the scenario, with a note and the limit in place of each number that is out of range.

        Args:   sources: entity and property behind each key.
        Raises: ScenarioError: another mistake; names the property and its line.
        """
        data = dict(values)
        while True:
            try:
                return model.model_validate(data)
            except ValidationError as error:
                for detail, problem in zip(error.errors(), problems(error, model), strict=True):
                    entity, name = sources.get(problem.key) or next(iter(sources.values()))
                    if detail["type"] not in _LIMITS or problem.key not in data:
                        raise entity.error(name, str(problem)) from None
                    limit = detail["ctx"][_LIMITS[detail["type"]]]
                    data[problem.key] = limit if detail["type"] != "greater_than" else 1.001 * limit
                    self.of(entity, name, f"{problem}: {data[problem.key]:g} is used")


class Values:
    """Reads properties as Stage does, in SI units, and records which ones were read."""

    def __init__(self, root: Entity, notes: Notes) -> None:
        """Read the units of the world."""
        self._read: set[Property] = set()
        self.names: set[str] = set()
        """Names of properties that have a meaning here."""
        self.notes = notes
        self._length_m = _LENGTHS_M[self.choice(root, "unit_length", tuple(_LENGTHS_M), "m")]
        self._angle_rad = _ANGLES_RAD[self.choice(root, "unit_angle", tuple(_ANGLES_RAD), "degrees")]

    def was_read(self, given: Property) -> bool:
        """Whether a property was read."""
        return given in self._read

    def numbers(self, entity: Entity, key: str, units: str, default: tuple[float, ...]) -> tuple[float, ...]:
        """Return numbers in SI units; further ones are ignored.

        Args:   units: one letter each: l a length, a an angle, f without unit.
                default: in SI units, if the file does not have the key.
        Raises: ScenarioError: a text, or too few values.
        """
        given = self._given(entity, key)
        if given is None:
            return default
        numbers = [self._number(given, value, units) for value in given.values[: len(units)]]
        if len(numbers) < len(units):
            self._not_numbers(given, units)
        if len(given.values) > len(units):
            self.notes.of(entity, key, f"only the first {len(units)} of {len(given.values)} values count, as in Stage")
        scale = {"l": self._length_m, "a": self._angle_rad, "f": 1.0}
        return tuple(number * scale[unit] for number, unit in zip(numbers, units, strict=True))

    def number(self, entity: Entity, key: str, unit: str, default: float) -> float:
        """Return one number in SI units; arguments and errors as in `numbers`."""
        return self.numbers(entity, key, unit, (default,))[0]

    def whole(self, entity: Entity, key: str, default: int) -> int:
        """Return a whole number, without decimals as in Stage. Raises: ScenarioError."""
        value = self.number(entity, key, "f", default)
        if value != int(value):
            self.notes.of(entity, key, f"{value:g} counts as {int(value)}, as in Stage")
        return int(value)

    def text(self, entity: Entity, key: str, default: str) -> str:
        """Return a text."""
        given = self._given(entity, key)
        value = given.values[0] if given is not None and given.values else default
        return value if isinstance(value, str) else f"{value:g}"

    def choice(self, entity: Entity, key: str, known: tuple[str, ...], default: str) -> str:
        """Return one of the known texts, the default instead of an unknown one, as in Stage."""
        value = self.text(entity, key, default)
        if value not in known:
            near = suggestion(value, known)
            self.notes.of(entity, key, f"'{value}' is not one of {', '.join(known)}: '{default}', as in Stage{near}")
            return default
        return value

    def pose(self, entity: Entity, key: str) -> tuple[Pose2, float]:
        """Return a pose and its z; zero without the key."""
        x, y, z, heading = self.numbers(entity, key, "llla", (0.0, 0.0, 0.0, 0.0))
        return (x, y, normalise_angle(heading)), z

    def size(self, entity: Entity, default: tuple[float, ...]) -> tuple[float, ...]:
        """Return the size of a body [m]; it is not negative, and only the height may be 0."""
        x, y, z = self.numbers(entity, "size", "lll", default)
        if min(x, y, z) < 0.0 or 0.0 in (x, y):
            self.notes.of(entity, "size", f"negative sizes count as positive, a width of 0 as {THIN_M:g} m")
        return abs(x) or THIN_M, abs(y) or THIN_M, abs(z)

    def _number(self, given: Property, value: Value, units: str) -> float:
        """Return a value as a number: what a text begins with, as atof does in Stage."""
        if isinstance(value, str):
            digits = re.match(r"\s*([-+]?(\d+\.?\d*|\.\d+))", value)
            if digits is None:
                self._not_numbers(given, units)
            if digits[0] != value:
                self.notes.say(given.place, f"{given.name}: '{value}' counts as {digits[1]}, as in Stage")
            value = float(digits[1])
        if abs(value) > MAX_NUMBER:
            self.notes.say(given.place, f"{given.name}: {value:g} counts as {math.copysign(MAX_NUMBER, value):.0f}")
        return min(max(value, -MAX_NUMBER), MAX_NUMBER)

    def _not_numbers(self, given: Property, units: str) -> NoReturn:
        form = f", {_FORMS[units]}" if units in _FORMS else ""
        wanted = f"{len(units)} numbers{form}" if len(units) > 1 else "a number"
        raise given.place.error(f"{given.name}: {_shown(given)} is not {wanted}")

    def _given(self, entity: Entity, key: str) -> Property | None:
        given = entity.get(key)
        self.names.add(key)
        if given is not None:
            self._read.add(given)
        return given


def compose(first: Pose2, second: Pose2) -> Pose2:
    """Return the pose `second`, given in the frame of `first`, in the frame in which `first` is given."""
    (x0, y0, yaw0), (x1, y1, yaw1) = first, second
    cos, sin = math.cos(yaw0), math.sin(yaw0)
    return x0 + cos * x1 - sin * y1, y0 + sin * x1 + cos * y1, normalise_angle(yaw0 + yaw1)


def tidy(value: float) -> float:
    """Return a number without the last digits, which come from unit conversion."""
    return round(value, 9) + 0.0


def _shown(given: Property) -> str:
    values = [f"'{value}'" if isinstance(value, str) else f"{value:g}" for value in given.values]
    return f"[{' '.join(values)}]" if len(values) != 1 else values[0]
