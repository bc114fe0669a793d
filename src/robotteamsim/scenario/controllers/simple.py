"""The controllers that have no keys of their own."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field

from robotteamsim.scenario.controllers.base import Control, ListeningControl


class GreedyControl(ListeningControl):
    """Drives to the loudest place nearby, each robot on its own."""

    controller: ClassVar[str] = "robotteamsim.control.baselines.greedy:GreedyController"
    maps: ClassVar[tuple[str, ...]] = ("known", "unknown")
    drives_to_areas: ClassVar[bool] = True

    algorithm: Literal["greedy"] = Field(description="greedy")


class RandomWalkControl(Control):
    """Wanders."""

    controller: ClassVar[str] = "robotteamsim.control.baselines.random_walk:RandomWalkController"
    maps: ClassVar[tuple[str, ...]] = ("known", "unknown")

    algorithm: Literal["random_walk"] = Field(description="random_walk")


class RelayControl(Control):
    """Stands where it connects others best, by the keys of `relays`."""

    controller: ClassVar[str] = "robotteamsim.control.people.relay:RelayController"

    algorithm: Literal["relay"] = Field(description="relay")
