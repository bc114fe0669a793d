"""Where a robot believes that it is."""

from __future__ import annotations

from typing import Literal

import msgspec

from robotteamsim.geometry import Pose

LocalisationState = Literal["tracking", "lost", "ambiguous"]
"""A robot knows where it is; it does not; there are several places where it may be."""


class Estimate(msgspec.Struct, frozen=True):
    """A place where a robot may be.

    pose:       in `map`.
    covariance: of its error in x, y [m] and yaw [rad], in `map`: xx, xy, x yaw, yy, y yaw, yaw yaw.
    """

    pose: Pose
    covariance: tuple[float, ...] = (0.0,) * 6


class Localisation(msgspec.Struct, frozen=True):
    """Where a robot believes that it is in one step.

    estimates: the most likely place, `Observation.pose`, and the others if it is ambiguous; not empty.
    """

    state: LocalisationState
    estimates: tuple[Estimate, ...]

    @property
    def pose(self) -> Pose:
        """The most likely pose, in `map`."""
        return self.estimates[0].pose
