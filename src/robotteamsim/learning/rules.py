"""What agents perceive, decide and are rewarded for, and when."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import msgspec
import numpy as np

from robotteamsim.learning.act import Act
from robotteamsim.learning.errors import LearningError
from robotteamsim.learning.observe import LARGEST_PART, MOST_TEAMMATES, Observe
from robotteamsim.learning.reward import Reward, SearchReward
from robotteamsim.scenario import Scenario

AnyScenario = str | os.PathLike[str] | Scenario
"""A file, a shipped name, or a scenario."""


class Rules(msgspec.Struct, frozen=True, kw_only=True):
    """What agents perceive, decide and are rewarded for, and when; see `parallel_env`.

    teammates: how many teammates an observation has room for; None: as many as there are.
    """

    observe: type[Observe] = Observe
    act: type[Act] = Act
    reward: type[Reward] = SearchReward
    every: int = 5
    said: int = 0
    max_cycles: int | None = None
    teammates: int | None = None

    @classmethod
    def of(cls, given: Mapping[str, Any]) -> Rules:
        """Return the rules of an environment.

        Raises: LearningError: a key is unknown, or its value is of another kind or out of range.
        """
        for key in given:
            if key not in cls.__struct_fields__:
                raise LearningError(f"{key}: unknown; expected one of {', '.join(cls.__struct_fields__)}")
        for key, base in (("observe", Observe), ("act", Act), ("reward", Reward)):
            value = given.get(key, base)
            if not (isinstance(value, type) and issubclass(value, base)):
                raise LearningError(f"{key}: {value!r:.60}; expected a class derived from {base.__name__}")
        for key, least, most in (
            ("every", 1, None),
            ("said", 0, LARGEST_PART),
            ("max_cycles", 1, None),
            ("teammates", 0, MOST_TEAMMATES),
        ):
            value = given.get(key, least)
            if value is None and key in ("max_cycles", "teammates"):
                continue
            is_whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
            if not is_whole or value < least or (most is not None and value > most):
                limits = f"of at least {least}" if most is None else f"from {least} to {most}"
                raise LearningError(f"{key}: {value!r:.60}; expected a whole number {limits}")
        return cls(**given)
