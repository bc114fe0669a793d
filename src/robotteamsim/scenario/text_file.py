"""Reading text files of users: not larger than any that is meant, so that none can fill the memory."""

from __future__ import annotations

from pathlib import Path

from robotteamsim.errors import ScenarioError

MAX_BYTES = 4 * 2**20
"""Ten times the floor plan of a large building."""


def read_text(path: Path, place: str, errors: str = "strict") -> str:
    """Return the text of a file in UTF-8.

    Args:   place: what error messages call the file. errors: as for `bytes.decode`.
    Raises: ScenarioError: the file is missing, unreadable, too large or not UTF-8.
    """
    try:
        with path.open("rb") as file:
            data = file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        raise ScenarioError(f"{place}: there is no such file") from None
    except ValueError:  # a NUL in the name
        raise ScenarioError(f"{place}: not a file name") from None
    except OSError as error:
        raise ScenarioError(f"{place}: {error.strerror or error}") from None
    if len(data) > MAX_BYTES:
        raise ScenarioError(f"{place}: larger than {MAX_BYTES // 2**20} MiB; expected a text file")
    try:
        return data.decode("utf-8-sig", errors)
    except UnicodeDecodeError:
        raise ScenarioError(f"{place}: not a text file in UTF-8") from None
