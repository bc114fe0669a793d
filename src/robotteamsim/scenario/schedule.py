"""What happens to the team by itself, at given times: robots that fail, robots that come."""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import Field, model_validator

from robotteamsim.scenario.base import Model, PlanarPose, wrong


class ScheduledEvent(Model):
    """A robot that leaves or comes: one of `remove` and `spawn`."""

    at_s: float = Field(ge=0.0, le=1e6, description="with the first step that begins then or later [s]")
    remove: int | None = Field(default=None, ge=0, le=2999, description="id of the robot that is taken off the floor")
    spawn: int | None = Field(
        default=None, ge=0, le=2999, description="id of the robot that comes, as soon as its place is free"
    )
    pose: PlanarPose | None = Field(
        default=None, description="where it comes, [x, y, yaw]; none: its start pose [m, m, rad, map]"
    )

    @model_validator(mode="after")
    def _check(self) -> ScheduledEvent:
        if (self.remove is None) == (self.spawn is None):
            raise wrong("remove", "wanted the id of a robot here, or as spawn, and not both")
        if self.pose is not None and self.spawn is None:
            raise wrong("pose", "is where a robot comes, and none is spawned")
        return self

    @property
    def robot_id(self) -> int:
        """The robot that it concerns."""
        return self.remove if self.remove is not None else self.spawn or 0


def in_order(schedule: Sequence[ScheduledEvent]) -> list[tuple[int, ScheduledEvent]]:
    """Return what happens, with its place in the list, in the order of time; at one time in that of the list."""
    return sorted(enumerate(schedule), key=lambda item: item[1].at_s)


def problem_of(schedule: Sequence[ScheduledEvent], present: Sequence[bool]) -> tuple[str, str] | None:
    """Return key and what is wrong with it, where the schedule cannot be followed; `present`: who starts."""
    there = list(present)
    for index, happening in in_order(schedule):
        robot_id, comes = happening.robot_id, happening.spawn is not None
        key = f"schedule.{index}.{'spawn' if comes else 'remove'}"
        if robot_id >= len(there):
            return key, f"there is no robot {robot_id}, only 0 to {len(there) - 1}"
        if there[robot_id] == comes:
            return key, f"robot {robot_id} is {'there already' if comes else 'not there'} at {happening.at_s:g} s"
        there[robot_id] = comes
    return None
