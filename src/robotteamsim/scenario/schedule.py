"""Robots that leave and arrive at given times."""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import Field, model_validator

from robotteamsim.scenario.base import Model, PlanarPose, wrong


class ScheduledEvent(Model):
    """A robot that leaves or arrives: one of `remove` and `spawn`."""

    at_s: float = Field(ge=0.0, le=1e6, description="takes effect in the first step that begins then or later [s]")
    remove: int | None = Field(default=None, ge=0, le=2999, description="id of the robot to remove")
    spawn: int | None = Field(
        default=None, ge=0, le=2999, description="id of the robot to spawn, as soon as its place is free"
    )
    pose: PlanarPose | None = Field(
        default=None, description="[x, y, yaw] of the spawned robot; default: its start pose [m, m, rad, map]"
    )

    @model_validator(mode="after")
    def _check(self) -> ScheduledEvent:
        if (self.remove is None) == (self.spawn is None):
            raise wrong("remove", "expected either remove or spawn, with the id of a robot")
        if self.pose is not None and self.spawn is None:
            raise wrong("pose", "only allowed with spawn")
        return self

    @property
    def robot_id(self) -> int:
        """The robot that leaves or arrives."""
        return self.remove if self.remove is not None else self.spawn or 0


def in_order(schedule: Sequence[ScheduledEvent]) -> list[tuple[int, ScheduledEvent]]:
    """Return the events with their index in the list, in order of time; simultaneous ones in the order of the list."""
    return sorted(enumerate(schedule), key=lambda item: item[1].at_s)


def problem_of(schedule: Sequence[ScheduledEvent], present: Sequence[bool]) -> tuple[str, str] | None:
    """Return a key and its mistake if the schedule contradicts itself. Args: present: at the start, per robot."""
    there = list(present)
    for index, event in in_order(schedule):
        robot_id, arrives = event.robot_id, event.spawn is not None
        key = f"schedule.{index}.{'spawn' if arrives else 'remove'}"
        if robot_id >= len(there):
            return key, f"there is no robot {robot_id}; expected 0 to {len(there) - 1}"
        if there[robot_id] == arrives:
            return key, f"robot {robot_id} is {'already' if arrives else 'not'} present at {event.at_s:g} s"
        there[robot_id] = arrives
    return None
