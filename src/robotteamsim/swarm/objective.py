"""A user's objective, with checks of the values that it returns."""

from collections.abc import Callable
from typing import Any

import numpy as np


class UndefinedValue(Exception):  # noqa: N818 - it ends a run and is not an error of the caller
    """The objective returned NaN; the message names particle and position."""


class Objective:
    """Values of positions, larger is better: `sign` times the value of the function. Counts evaluations."""

    def __init__(self, fun: Callable[[np.ndarray], Any], vectorized: bool, sign: float) -> None:
        self._fun = fun
        self._vectorized = vectorized
        self.sign = sign
        self.nfev = 0

    def __call__(self, positions: np.ndarray) -> np.ndarray:
        """Return the values at positions, shape (n, dimensions); float64, shape (n,).

        Raises: ValueError: the function raised (its error is the cause), or returned another shape or not a number.
                UndefinedValue: it returned NaN.
        """
        values = self._all_at_once(positions) if self._vectorized else self._one_by_one(positions)
        self.nfev += len(positions)
        undefined = np.isnan(values)
        if np.any(undefined):
            index = int(np.argmax(undefined))
            raise UndefinedValue(f"the objective returned nan for particle {index} at {positions[index].tolist()}")
        return self.sign * values

    def _all_at_once(self, positions: np.ndarray) -> np.ndarray:
        who = f"{len(positions)} particles at once"
        values = _as_numbers(self._ask(positions, who), who)
        if values.shape != (len(positions),):
            raise ValueError(f"the objective must return shape ({len(positions)},) for {who}, got {values.shape}")
        return values

    def _one_by_one(self, positions: np.ndarray) -> np.ndarray:
        values = np.empty(len(positions))
        for index, position in enumerate(positions):
            who = f"particle {index} at {position.tolist()}"
            value = _as_numbers(self._ask(position, who), who)
            if value.size != 1:
                raise ValueError(f"the objective must return one number for {who}, got shape {value.shape}")
            values[index] = value.item()
        return values

    def _ask(self, places: np.ndarray, who: str) -> Any:
        try:
            return self._fun(places.copy())
        except Exception as error:
            raise ValueError(f"the objective raised {type(error).__name__} for {who}: {error}") from error


def _as_numbers(answer: Any, who: str) -> np.ndarray:
    try:
        return np.asarray(answer, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"the objective must return numbers for {who}, got {answer!r}") from error
