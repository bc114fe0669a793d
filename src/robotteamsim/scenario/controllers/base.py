"""What all controllers have in common. Each family of controllers is one file: their keys, and the class of each.

A controller that is added is one class here below `Control`, and one line in `scenario.controllers.AnyControl`.
"""

from __future__ import annotations

from typing import ClassVar, Literal, TypeVar, get_args

from pydantic import Field, model_validator

from robotteamsim.scenario.base import SMALLEST, Model
from robotteamsim.scenario.controllers.driving import NavigatorTuning, WanderTuning
from robotteamsim.scenario.controllers.localisation import LaserLocalisation
from robotteamsim.scenario.controllers.mapping import Mapping

Kind = TypeVar("Kind", bound="Control")


class Control(Model):
    """The keys of every controller; firefighters and relays use them, too.

    controller: the class that reads the keys, as module:Class; it is imported when a mission needs it.
    drives_to_areas: whether it drives to the area of its task; others explore areas by passing them.
    values_areas: whether it can choose areas by what it expects there, and enters the last one when its search is over.
    patrols:    whether it visits the vertices of `mission.patrol`, whose idleness is then measured.
    maps:       the values of `map` with which it makes sense.
    """

    controller: ClassVar[str] = ""
    drives_to_areas: ClassVar[bool] = False
    values_areas: ClassVar[bool] = False
    patrols: ClassVar[bool] = False
    maps: ClassVar[tuple[str, ...]] = ("known",)

    algorithm: str = Field(description="name of the controller")
    iteration_s: float = Field(default=1.0, ge=SMALLEST, le=60.0, description="period of the swarm's iterations [s]")
    max_step_speed_mps: float = Field(
        default=0.58, ge=SMALLEST, le=10.0, description="limit of the swarm velocity [m/s]"
    )
    navigation: Literal["path", "straight"] = Field(
        default="path", description="distances and directions along free paths of the known map, or in a straight line"
    )
    localisation: Literal["ground_truth", "odometry", "laser", "tf"] = Field(
        default="ground_truth",
        description="source of the robot's pose; odometry: not corrected, so robots get lost in minutes; "
        "laser: corrected by scans, see laser_localisation; tf: transform map -> robot_<id>/base_link, only in ROS",
    )
    map: Literal["known", "unknown"] = Field(
        default="known",
        description="unknown: robots know the bounds of the building alone; they map it with their lasers, and share "
        "what they find. localisation is laser then, if it is not given",
    )
    tf_timeout_s: float = Field(
        default=0.3,
        ge=SMALLEST,
        le=60.0,
        description="with localisation tf, a robot without a new transform for this time stops [s]",
    )
    laser_localisation: LaserLocalisation = LaserLocalisation()
    mapping: Mapping = Mapping()
    navigator: NavigatorTuning = NavigatorTuning()
    wander: WanderTuning = WanderTuning()

    @model_validator(mode="before")
    @classmethod
    def _without_true_poses(cls, data: object) -> object:
        """A robot that does not know the building does not know its pose either, unless the scenario says so."""
        if isinstance(data, dict) and data.get("map") == "unknown":
            return {"localisation": "laser", **data}
        return data

    @property
    def localises(self) -> bool:
        """Whether robots find out themselves where they are, from what they measure."""
        return self.localisation in ("odometry", "laser") or self.map == "unknown"

    @property
    def several_swarms(self) -> bool:
        """Whether the team may be several swarms."""
        return False

    def check_number(self, num_robots: int) -> None:
        """Raise the scenario's error of keys that do not fit this number of robots."""

    def as_kind(self, kind: type[Kind], **keys: object) -> Kind:
        """Return the keys of another kind of controller: those that both have, and some others; defaults for the rest.

        So a class of a user may be below one of ours, and PSO may be RDPSO without some of its terms.
        """
        if isinstance(self, kind) and not keys:
            return self
        (name,) = get_args(kind.model_fields["algorithm"].annotation)
        shared = {key: getattr(self, key) for key in type(self).model_fields if key in kind.model_fields}
        return kind(**{**shared, **keys, "algorithm": name})


class ListeningControl(Control):
    """The keys of controllers that follow voices."""

    rule_out_places: bool = Field(
        default=True,
        description="voices at places where no victim can be are neither local nor global bests; false: all count",
    )


class LinkTuning(Model):
    """How the communication term of eq. (22) keeps links."""

    gated: bool = Field(
        default=True,
        description="the term acts only while a link is endangered; false: always, with c4, as in the printed eq. (22)",
    )
    endangered_fraction: float = Field(
        default=0.8,
        ge=SMALLEST,
        lt=1.0,
        description="a link by distance is endangered beyond this fraction of network.max_distance_m",
    )


class LinkedControl(Control):
    """The keys of the communication term of eq. (22)."""

    c4: float = Field(
        default=0.4,
        ge=0.0,
        le=2.0,
        description="communication weight; acts while a link is endangered, or always without communication.gated",
    )
    kept_link: Literal["nearest", "tree"] = Field(
        default="nearest",
        description="link that the communication term keeps: that to the nearest teammate, or the weakest of the "
        "robot's own links in the strongest spanning tree of the team",
    )
    communication: LinkTuning = LinkTuning()


class OtherControl(Control):
    """A controller of an installed package, any module:Class, or the file of a learned policy."""

    drives_to_areas: ClassVar[bool] = True
    maps: ClassVar[tuple[str, ...]] = ("known", "unknown")

    algorithm: str = Field(
        description="name of a controller of an installed package, module:Class, or a file .pt or .pt2 of a policy"
    )


def is_policy_file(algorithm: str) -> bool:
    """Whether an algorithm is the file of a learned policy, see `robotteamsim.learning.export_policy`."""
    return algorithm.endswith((".pt", ".pt2"))
