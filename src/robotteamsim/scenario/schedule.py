"""What changes at given times: robots, their levels, doors, lights, noise, victims and fire."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal, get_args

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from robotteamsim.scenario.base import Model, Name, NoiseDb, PlanarPose, Point, wrong

EventKind = Literal["remove", "spawn", "take_passage", "door", "light", "noise_db", "victim", "ignite"]
EVENTS: tuple[EventKind, ...] = get_args(EventKind)
DETAILS: dict[str, EventKind] = {
    **{"pose": "spawn", "level": "take_passage", "closed": "door"},
    **{"lit": "light", "position": "victim"},
}
"""Keys that are only allowed with one kind of event."""


class ScheduledEvent(Model):
    """One change: exactly one of the keys in `EVENTS`, with its details."""

    at_s: float = Field(ge=0.0, le=1e6, description="takes effect in the first step that begins then or later [s]")
    remove: int | None = Field(default=None, ge=0, le=2999, description="id of the robot to remove")
    spawn: int | None = Field(
        default=None, ge=0, le=2999, description="id of the robot to spawn, as soon as its place is free"
    )
    pose: PlanarPose | None = Field(
        default=None, description="[x, y, yaw] of the spawned robot; default: its start pose [m, m, rad, map]"
    )
    take_passage: int | None = Field(
        default=None, ge=0, le=2999, description="id of the robot to go to a level, from a stop that leads there"
    )
    level: str | None = Field(default=None, description="name of the level to which it goes")
    door: str | None = Field(default=None, description="name of the door to close or open")
    closed: bool | None = Field(default=None, description="whether the door closes (true) or opens (false)")
    light: str | None = Field(default=None, description="name of the light to switch; only in `run.world: mujoco`")
    lit: bool | None = Field(default=None, description="whether the light is on (true) or off (false)")
    noise_db: NoiseDb | None = Field(default=None, description="new background noise [dB]")
    victim: Name | None = Field(default=None, description="name of the victim to add or to move")
    position: Point | None = Field(default=None, description="[x, y] of this victim in the map frame [m]")
    ignite: Point | None = Field(default=None, description="[x, y] of the place that starts to burn [m, map]")

    @model_validator(mode="after")
    def _check(self) -> ScheduledEvent:
        given = self._given_kinds()
        if len(given) != 1:
            found = " and ".join(given) or "none"
            raise wrong("", f"expected exactly one of {', '.join(EVENTS)}; found {found}")
        for key, kind in DETAILS.items():
            if getattr(self, key) is not None and kind != given[0]:
                raise wrong(key, f"only allowed with {kind}")
        if self.take_passage is not None and self.level is None:
            raise wrong("level", "missing; expected the name of a level")
        if self.door is not None and self.closed is None:
            raise wrong("closed", "missing; expected true or false")
        if self.light is not None and self.lit is None:
            raise wrong("lit", "missing; expected true or false")
        if self.victim is not None and self.position is None:
            raise wrong("position", "missing; expected [x, y] in the map frame [m]")
        return self

    @model_serializer(mode="wrap")
    def _without_other_kinds(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Leave out the keys of other kinds, so that an event is written as a user would write it."""
        return {key: value for key, value in handler(self).items() if value is not None}

    def _given_kinds(self) -> list[EventKind]:
        return [kind for kind in EVENTS if getattr(self, kind) is not None]

    @property
    def kind(self) -> EventKind:
        """What it changes; also the key with its subject."""
        return self._given_kinds()[0]

    @property
    def robot_id(self) -> int | None:
        """The robot that leaves, arrives or takes a passage; None for other kinds."""
        return next((one for one in (self.remove, self.spawn, self.take_passage) if one is not None), None)


def in_order(schedule: Sequence[ScheduledEvent]) -> list[tuple[int, ScheduledEvent]]:
    """Return the events with their index in the list, in order of time; simultaneous ones in the order of the list."""
    return sorted(enumerate(schedule), key=lambda item: item[1].at_s)


def check_schedule(
    schedule: Sequence[ScheduledEvent],
    present: Sequence[bool],
    doors: Sequence[str],
    lights: Sequence[str],
    levels: Callable[[int], Sequence[str]],
) -> None:
    """Raise the error of a schedule that contradicts itself, the team or the plan.

    Args: present: at the start, per robot.  doors, lights: the names of the plan's doors, and of the lights.
          levels:  returns the names of those to which a robot can go.
    """
    for index, event in enumerate(schedule):
        if event.door is not None and event.door not in doors:
            known = ", ".join(doors) or "none"
            raise wrong(f"schedule.{index}.door", f"there is no door '{event.door}'; known: {known}")
        if event.light is not None and event.light not in lights:
            known = ", ".join(lights) or "none"
            raise wrong(f"schedule.{index}.light", f"there is no light '{event.light}'; known: {known}")
    there = list(present)
    for index, event in in_order(schedule):
        robot_id, arrives = event.robot_id, event.spawn is not None
        if robot_id is None:
            continue
        key = f"schedule.{index}.{event.kind}"
        if robot_id >= len(there):
            raise wrong(key, f"there is no robot {robot_id}; expected 0 to {len(there) - 1}")
        if event.level is not None and event.level not in (served := levels(robot_id)):
            known = f"known: {', '.join(served) or 'none'}"
            raise wrong(f"schedule.{index}.level", f"there is no passage to level '{event.level}'; {known}")
        if there[robot_id] == arrives:
            raise wrong(key, f"robot {robot_id} is {'already' if arrives else 'not'} present at {event.at_s:g} s")
        there[robot_id] = event.remove is None
