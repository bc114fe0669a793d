"""The keys of the particle swarm family: RDPSO [dissertation, eq. 22, 24, 25], DPSO, RPSO and PSO."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field, model_validator

from robotteamsim.scenario.base import SMALLEST, Model, wrong
from robotteamsim.scenario.controllers.base import LinkedControl, ListeningControl
from robotteamsim.scenario.controllers.driving import DoorTuning


class SocialExclusion(Model):
    """When a robot leaves the swarm and comes back [dissertation, eq. 12 and 5.2.2]."""

    enabled: bool = Field(default=True, description="whether robots are excluded at all")
    search_counter_max: int = Field(default=15, ge=1, le=10_000, description="SC_max: iterations without improvement")
    while_approaching: bool = Field(
        default=False,
        description="whether iterations count in which a member came nearer to the global best than before; "
        "true: as printed",
    )
    min_robots: int = Field(
        default=1,
        ge=0,
        le=3000,
        description="a swarm of this size or smaller is dissolved at SC_max",
    )
    max_robots: int = Field(default=15, ge=1, le=3000, description="a swarm of this size includes no more robots")

    @model_validator(mode="after")
    def _check(self) -> SocialExclusion:
        if self.max_robots < self.min_robots:
            raise wrong("max_robots", f"{self.max_robots} is below min_robots, {self.min_robots}")
        return self


class Swarms(Model):
    """How many swarms the team has [5.2.2]; the number of robots in a swarm is limited by `exclusion`."""

    min: int = Field(default=1, ge=0, le=3000, description="number of swarms that are never dissolved")
    initial: int = Field(default=1, ge=1, le=3000, description="number at the start, each a run of consecutive robots")
    max: int = Field(default=1, ge=1, le=3000, description="no new swarm is founded beyond this number")
    new_robots: int = Field(default=5, ge=1, le=3000, description="number of excluded robots that found a new swarm")

    @model_validator(mode="after")
    def _check(self) -> Swarms:
        if self.initial < self.min:
            raise wrong("initial", f"{self.initial} is below min, {self.min}")
        if self.max < self.initial:
            raise wrong("max", f"{self.max} is below initial, {self.initial}")
        return self


class SwarmControl(ListeningControl):
    """The keys of the whole family."""

    drives_to_areas: ClassVar[bool] = True
    maps: ClassVar[tuple[str, ...]] = ("known", "unknown")

    memory_of: Literal["motion", "commands"] = Field(
        default="motion",
        description="velocities in the memory: those that the robot really had, or (as printed) those that it chose",
    )
    c1: float = Field(default=0.08, ge=0.0, le=2.0, description="cognitive weight")
    c2: float = Field(default=0.11, ge=0.0, le=2.0, description="social weight")
    speed_factor: float = Field(
        default=1.25,
        ge=1.0,
        le=10.0,
        description="robots drive faster than the swarm velocity by this factor, to arrive before the next iteration",
    )
    update_timeout_share: float = Field(
        default=0.5,
        ge=0.0,
        le=1.0,
        description="fraction of an iteration for which a robot waits for updates of robots heard in the last one",
    )
    member_timeout_s: float = Field(
        default=30.0,
        ge=SMALLEST,
        le=1e6,
        description="a member that was not heard for longer no longer attracts others [s]",
    )
    longest_detour_m: float = Field(
        default=60.0,
        ge=SMALLEST,
        le=10_000.0,
        description="bests with a longer path attract in a straight line [m]",
    )
    doors: DoorTuning = DoorTuning()


class SeveralSwarmsControl(SwarmControl):
    """The keys of a team that may be several swarms, which exclude and include robots."""

    exclusion: SocialExclusion = SocialExclusion()
    swarms: Swarms = Swarms()

    @property
    def several_swarms(self) -> bool:
        """See `Control`."""
        return self.swarms.max > 1

    def check_number(self, num_robots: int) -> None:
        """See `Control`."""
        if num_robots and self.swarms.initial > num_robots:
            text = f"{self.swarms.initial} swarms need at least as many robots, not {num_robots}"
            raise wrong("control.swarms.initial", text)

    @model_validator(mode="after")
    def _check_swarms(self) -> SeveralSwarmsControl:
        if self.swarms.max > 1 and self.swarms.new_robots > self.exclusion.max_robots:
            new, most = self.swarms.new_robots, self.exclusion.max_robots
            raise wrong("swarms.new_robots", f"{new} is above exclusion.max_robots, {most}")
        return self


class ObstacleControl(SwarmControl):
    """The keys of the obstacle term."""

    c3: float = Field(default=0.29, ge=0.0, le=2.0, description="obstacle weight")
    sensing_radius_m: float = Field(default=1.0, ge=SMALLEST, le=50.0, description="r_s of the obstacle term [m]")


class InertiaControl(SwarmControl):
    """The key of velocities with an inertia instead of a fractional memory."""

    inertia: float = Field(default=0.6, ge=0.0, le=1.0, description="w, the weight of v[t]")


class RdpsoControl(LinkedControl, ObstacleControl, SeveralSwarmsControl):
    """RDPSO, with all terms of eq. (22)."""

    controller: ClassVar[str] = "robotteamsim.control.rdpso.controller:RdpsoController"

    algorithm: Literal["rdpso"] = Field(default="rdpso", description="rdpso")
    memory: Literal["published", "grunwald_letnikov"] = Field(
        default="published", description="fractional memory (24) or (23)"
    )
    alpha: float = Field(default=0.38, ge=0.0, le=1.0, description="fractional order")
    memory_terms: int = Field(default=4, ge=1, le=20, description="r: truncation; at most 4 with `published`")
    adaptation: Literal["none", "crisp", "fuzzy"] = Field(
        default="none",
        description="alpha and c1 to c4 follow the context by the rules of 5.2.2, with crisp or fuzzy memberships",
    )

    @model_validator(mode="after")
    def _check_memory(self) -> RdpsoControl:
        if self.memory == "published" and self.memory_terms > 4:
            raise wrong("memory_terms", f"{self.memory_terms} is above 4, the length of the published memory")
        return self


class Punishment(SocialExclusion):
    """When a swarm of a DPSO loses a robot [dissertation, eq. 12 and 5.1.2]: without the exceptions for an RDPSO."""

    while_approaching: bool = Field(
        default=True,
        description="whether iterations count in which a member came nearer to the global best than before; "
        "true: as printed",
    )
    min_robots: int = Field(
        default=0, ge=0, le=3000, description="a swarm of this size or smaller is dissolved at SC_max"
    )


class Offspring(Swarms):
    """How many swarms a DPSO has [5.1.2]; the numbers are ours."""

    min: int = Field(default=0, ge=0, le=3000, description="number of swarms that are never dissolved")
    max: int = Field(default=4, ge=1, le=3000, description="no child swarm is founded beyond this number")
    new_robots: int = Field(
        default=2, ge=1, le=3000, description="number of robots of a child swarm, half of them from a mate"
    )


class DpsoControl(InertiaControl, SeveralSwarmsControl):
    """DPSO: several swarms that each move by PSO (14), with natural selection (12, 13)."""

    controller: ClassVar[str] = "robotteamsim.control.baselines.pso:DpsoController"

    algorithm: Literal["dpso"] = Field(description="dpso")
    exclusion: Punishment = Punishment()
    swarms: Offspring = Offspring()


class RpsoControl(InertiaControl, ObstacleControl):
    """RPSO (15): inertia, local and global best, obstacles; no robot is excluded."""

    controller: ClassVar[str] = "robotteamsim.control.baselines.pso:RpsoController"

    algorithm: Literal["rpso"] = Field(description="rpso")


class PsoControl(InertiaControl):
    """PSO (14): inertia, local and global best; no robot is excluded."""

    controller: ClassVar[str] = "robotteamsim.control.baselines.pso:PsoController"

    algorithm: Literal["pso"] = Field(description="pso")
