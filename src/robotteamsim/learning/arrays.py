"""Arrays of what users and their classes give."""

from __future__ import annotations

from typing import Any

import numpy as np

from robotteamsim.learning.errors import LearningError


def array_of(values: Any) -> np.ndarray:
    """Return values as an array; masked ones, and rows with different lengths, as one of type object."""
    if type(values) is np.ndarray:
        return values
    if any(np.ma.isMaskedArray(value) for value in (values if isinstance(values, list) else [values])):
        return np.asarray(None)
    try:
        return np.asarray(values)
    except ValueError:
        return np.asarray(None)


def numbers_of(name: str, values: Any, shape: tuple[int, ...]) -> np.ndarray:
    """Return values as an array, float64. Raises: LearningError: they are not finite numbers, or have another shape."""
    array = array_of(values)
    if array.shape != shape or array.dtype.kind not in "biuf":
        raise LearningError(f"{name}: {shown(array)}, shape {array.shape}; expected finite numbers, shape {shape}")
    if not np.isfinite(array).all():
        place = np.argwhere(~np.isfinite(array))[0].tolist()
        raise LearningError(f"{name}{place}: {array[tuple(place)]}; expected finite numbers")
    return array.astype(np.float64)


def shown(array: np.ndarray) -> str:
    """Return the beginning of an array, for a message of one line."""
    return " ".join(repr(array).split())[:60]
