"""Users' own parts, such as controllers and sensors: packages register them as entry points of a group."""

import contextlib
import importlib
import logging
import sys
from collections.abc import Callable, Container
from importlib.metadata import EntryPoint, entry_points
from typing import Any, TypeVar

from robotteamsim.errors import RobotTeamSimError
from robotteamsim.extras import missing_extra
from robotteamsim.wording import described

Part = TypeVar("Part")


class PartError(RobotTeamSimError):
    """A part cannot be loaded."""


def own_parts(group: str) -> dict[str, EntryPoint]:
    """Return the entry points of a group, such as `robotteamsim.worlds`, by name, sorted."""
    return {point.name: point for point in sorted(entry_points(group=group))}


def load_part(point: EntryPoint) -> Any:
    """Return what an entry point names. Raises: PartError: it cannot be imported; one line."""
    # Otherwise files that were added after the last import are not found.
    importlib.invalidate_caches()
    try:
        with contextlib.redirect_stdout(sys.stderr):  # what a module prints is no output of a command
            return point.load()
    except ModuleNotFoundError as error:
        reason = missing_extra(error) or f"{described(error)}; is its folder in PYTHONPATH?"
        raise PartError(reason) from None
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # Any error in the user's module is reported in one line.
        raise PartError(described(error)) from None


def load_parts(group: str, ours: Container[str], checked: Callable[[str, Any], Part]) -> dict[str, Part]:
    """Return the parts that packages register in a group, by name. One that cannot be used is a warning.

    Args: ours:    names that are taken.
          checked: returns a part of that name; raises an error with one line if it is none.
    """
    kind, found = group.rpartition(".")[2].removesuffix("s"), {}
    for name, point in own_parts(group).items():
        try:
            if name in ours:
                raise ValueError(f"there is another {kind} of this name")
            found[name] = checked(name, load_part(point))
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # as above
            problem = error if isinstance(error, PartError) else described(error)
            logging.getLogger(__name__).warning("%s %s of %s: %s", kind, name, point.value, problem)
    return found


def check_texts(part: Any, *attributes: str) -> None:
    """Raises: TypeError: an attribute of a user's part is no text."""
    for attribute in attributes:
        if not isinstance(value := getattr(part, attribute), str):
            raise TypeError(f"{attribute} {value!r:.40}; expected a text")


def class_below(base: type, found: Any, *attributes: str) -> Any:
    """Return a class of users. Raises: TypeError: it is not one below `base`, or lacks an attribute."""
    if not (isinstance(found, type) and issubclass(found, base)):
        raise TypeError(f"expected a class below {base.__module__}.{base.__qualname__}, not {found!r:.40}")
    for attribute in attributes:
        if not hasattr(found, attribute):
            raise TypeError(f"has no {attribute}; see {base.__module__}.{base.__qualname__}")
    return found
