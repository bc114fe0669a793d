"""Fire and smoke: fuel, ignitions, and the constants of the models. docs/fire.md has equations and sources."""

from __future__ import annotations

import itertools
from typing import Annotated, Any, Literal

import shapely
from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from robotteamsim.scenario.base import SMALLEST, HeatPoint, Many, Model, Name, Point, by_index, check_names, wrong
from robotteamsim.scenario.floor_plan import Door
from robotteamsim.scenario.yaml_text import shown

GrowthClass = Literal["slow", "medium", "fast", "ultra_fast"]

GROWTH_KW_PER_S2: dict[GrowthClass, float] = {"slow": 0.00293, "medium": 0.01172, "fast": 0.0469, "ultra_fast": 0.1876}
"""Growth coefficients of t-squared fires [nfpa204]: 1055 kW after 600, 300, 150 and 75 s."""

MAX_CELLS = 4_000_000

_MAX_KW = 1e7
_LEAST_KW, _SHORTEST_GROWTH_S, _LEAST_GROWTH_KW_S2 = 1.0, 1.0, 1e-6
"""Of the t-squared fire to which an own curve is compared."""


def _check_growth(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise wrong("", f"{shown(value)} is neither a class, such as fast, nor a number [kW/s^2]")
    return value


Growth = Annotated[
    Annotated[GrowthClass, Tag("<class>")] | Annotated[float, Field(ge=1e-6, le=1000.0), Tag("<number>")],
    Discriminator(lambda value: "<class>" if isinstance(value, str) else "<number>"),
    BeforeValidator(_check_growth),
]
"""A class of t-squared fires, or a growth coefficient [kW/s^2]."""

BLOCK_M = 1.0
"""Hot places count in blocks of this size, so that a fire that spreads changes maps only now and then."""

Block = tuple[int, int]
"""Row and column of a square of BLOCK_M, counted from the lower left corner of the plan."""

HotBlock = tuple[int, int, int]
"""A block and the highest temperature that was seen in it, rounded down [degC]."""

REPLAN_NS = 5 * 10**9
"""A map with new blocks is made at most once in this time, because it is expensive."""


class Fuel(Model):
    """What burns in one place: a disc, a polygon, or the room that contains a point. Later entries replace earlier."""

    name: Name = Field(description="a name, unique among fuels")
    room: Point | None = Field(
        default=None, description="[x, y] of any point of a room: all that can be reached without passing a door [m]"
    )
    polygon: Many[Point] | None = Field(default=None, min_length=3, description="corners in order [m]")
    center: Point | None = Field(default=None, description="[x, y] of a disc in the map frame [m]")
    radius_m: float | None = Field(default=None, ge=SMALLEST, le=1000.0, description="of the disc [m]")
    load_mj_m2: float = Field(default=400.0, ge=1.0, le=40_000.0, description="heat of all that burns [MJ/m^2]")
    growth: Growth = Field(
        default="medium", description="of the t-squared fire: slow, medium, fast, ultra_fast, or a number [kW/s^2]"
    )
    hrr: Many[HeatPoint] | None = Field(
        default=None,
        min_length=1,
        max_length=10_000,
        description="heat release rate of the whole place, instead of load_mj_m2 and growth: [[t_s, kw], ...] since it "
        "began to burn, linear between, 0 before the first time, constant after the last [s, kW]",
    )
    peak_kw_m2: float = Field(default=250.0, ge=1.0, le=10_000.0, description="highest heat release rate [kW/m^2]")

    @model_validator(mode="after")
    def _check(self) -> Fuel:
        given = [key for key in ("room", "polygon", "center") if getattr(self, key) is not None]
        if len(given) != 1:
            found = " and ".join(given) or "none"
            raise wrong("", f"expected exactly one of room, polygon, center; found {found}")
        if (self.center is None) != (self.radius_m is None):
            missing, other = ("radius_m", "center") if self.radius_m is None else ("center", "radius_m")
            raise wrong(missing, f"missing; expected together with {other}")
        if self.polygon is not None and not shapely.Polygon(self.polygon).is_valid:
            raise wrong("polygon", "crosses itself")
        self._check_hrr()
        return self

    def _check_hrr(self) -> None:
        if self.hrr is None:
            return
        for key in ("load_mj_m2", "growth"):
            if getattr(self, key) != type(self).model_fields[key].default:
                raise wrong(key, "not allowed together with hrr")
        for index, (time_s, kw) in enumerate(self.hrr):
            if not 0.0 <= time_s <= 1e6:
                raise wrong(f"hrr.{index}", f"the time {time_s:g} is not within 0 to 1e+06 s")
            if not 0.0 <= kw <= _MAX_KW:
                raise wrong(f"hrr.{index}", f"the rate {kw:g} is not within 0 to {_MAX_KW:g} kW")
        for index, ((before_s, _), (time_s, _)) in enumerate(itertools.pairwise(self.hrr), start=1):
            if time_s <= before_s:
                raise wrong(f"hrr.{index}", f"the time {time_s:g} is not after the one before, {before_s:g}")

    @property
    def growth_kw_s2(self) -> float:
        """Growth coefficient of the t-squared fire; with `hrr`, of the one that is as strong at its highest rate."""
        if self.hrr is not None:
            first_s, most_kw = max(self.hrr, key=lambda point: (point[1], -point[0]))
            growth = max(most_kw, _LEAST_KW) / max(first_s, _SHORTEST_GROWTH_S) ** 2
            return max(growth, _LEAST_GROWTH_KW_S2)
        return self.growth if isinstance(self.growth, float) else GROWTH_KW_PER_S2[self.growth]


class Ignition(Model):
    """A place that starts to burn."""

    at_s: float = Field(default=0.0, ge=0.0, le=1e6, description="time of the world [s]")
    position: Point = Field(description="[x, y] in the map frame, where there is fuel [m]")


class Soot(Model):
    """How much soot and carbon monoxide a fire produces, and how smoke spreads and dims light."""

    yield_g_g: float = Field(default=0.06, ge=0.0001, le=0.5, description="soot per mass of burnt fuel [g/g]")
    co_yield_g_g: float = Field(default=0.04, ge=0.0, le=0.5, description="carbon monoxide per mass of fuel [g/g]")
    heat_kj_g: float = Field(default=20.0, ge=1.0, le=150.0, description="heat of combustion [kJ/g]")
    diffusivity_m2_s: float = Field(
        default=0.15, ge=SMALLEST, le=10.0, description="of smoke and heat over the floor, by turbulence [m^2/s]"
    )
    height_m: float = Field(default=2.6, ge=1.0, le=50.0, description="height over which smoke mixes [m]")
    extinction_m2_g: float = Field(
        default=8.7, ge=SMALLEST, le=100.0, description="extinction per mass of soot [m^2/g]"
    )
    visibility_c: float = Field(
        default=3.0, ge=SMALLEST, le=20.0, description="C of Jin's C/K: 3 for reflecting things, 8 for lamps"
    )
    door_leakage: float = Field(
        default=0.01, ge=0.0, le=1.0, description="share of the smoke that passes a closed door that is not fireproof"
    )
    laser_optical_depth: float = Field(
        default=1.5, ge=SMALLEST, le=20.0, description="a laser gets no return from beyond this optical depth, one way"
    )


class Heat(Model):
    """Loss of heat to floor, ceiling and walls, and what robots and doors endure."""

    ambient_c: float = Field(default=20.0, ge=-40.0, le=60.0, description="temperature at the start [degC]")
    flame_c: float = Field(default=820.0, ge=100.0, le=2000.0, description="least temperature of a burning cell [degC]")
    convective_share: float = Field(default=0.7, ge=0.0, le=1.0, description="of the heat that warms the air")
    convection_w_m2_k: float = Field(default=10.0, ge=0.0, le=1000.0, description="loss by convection [W/(m^2 K)]")
    emissivity: float = Field(default=0.8, ge=0.0, le=1.0, description="of the hot air, for its loss by radiation")
    robot_limit_c: float = Field(
        default=80.0,
        ge=0.0,
        le=2000.0,
        description="highest temperature that robots endure indefinitely [degC]",
    )
    robot_endures_s: float = Field(
        default=30.0,
        ge=0.0,
        le=1e6,
        description="a robot fails after this time above robot_limit_c in total; to cool down does not reset it [s]",
    )
    block_c: float = Field(
        default=60.0, ge=0.0, le=2000.0, description="robots that sense heat avoid places as hot as this [degC]"
    )
    door_endures_s: float = Field(
        default=300.0, ge=0.0, le=1e6, description="time next to flames after which a closed door burns through [s]"
    )


class Casualties(Model):
    """At which fractional effective dose (FED) people collapse and die [purser2016]."""

    collapse_dose: float = Field(default=1.0, ge=SMALLEST, le=100.0, description="FED at which a person collapses")
    lethal_dose: float = Field(default=2.0, ge=SMALLEST, le=100.0, description="FED at which a person dies")

    @model_validator(mode="after")
    def _check(self) -> Casualties:
        if self.lethal_dose < self.collapse_dose:
            raise wrong("lethal_dose", f"{self.lethal_dose:g} is below collapse_dose, {self.collapse_dose:g}")
        return self


class Tenability(Model):
    """From when on conditions are untenable, for the available safe egress time; docs/fire.md has the terms."""

    dose: float = Field(
        default=0.3, ge=SMALLEST, le=100.0, description="FED that 11 % of the population do not endure [iso13571]"
    )
    visibility_m: float = Field(
        default=10.0,
        ge=0.0,
        le=30.0,
        description="people who see less far may not find their way: 10 for large enclosures, 5 for small ones "
        "[purser2016]; 0: does not count [m]",
    )


class Fire(Model):
    """Fire and smoke on a grid of the plan."""

    fuel: Many[Fuel] = Field(default=(), max_length=1000, description="what burns, by place; the rest does not burn")
    ignitions: Many[Ignition] = Field(default=(), max_length=1000, description="where and when it starts to burn")
    fireproof: Many[str] = Field(
        default=(),
        description="names of doors that never burn through, as those of kind fireproof without a rating",
    )
    cell_m: float = Field(
        default=0.5, ge=0.1, le=5.0, description="size of a cell; doorways in oblique walls must be wider [m]"
    )
    growth_sd: float = Field(
        default=0.2, ge=0.0, le=0.5, description="standard deviation of a place's growth coefficient over its mean"
    )
    gap_m: float = Field(default=1.0, ge=0.0, le=5.0, description="fire crosses ground without fuel of this width [m]")
    update_s: float = Field(default=1.0, ge=0.05, le=10.0, description="fire and smoke advance at this interval [s]")
    soot: Soot = Soot()
    heat: Heat = Heat()
    casualties: Casualties = Casualties()
    tenability: Tenability = Tenability()
    fds: str | None = Field(
        default=None,
        description="folder with the results of FDS, instead of fuel and ignitions; relative to the current folder",
    )
    fds_ignition_s: float = Field(
        default=0.0, ge=0.0, le=1e6, description="when the clock of FDS, which begins with the fire, begins [s]"
    )
    fds_height_m: float = Field(
        default=1.5, ge=-1000.0, le=1000.0, description="of several slices of FDS, those nearest to this z are read [m]"
    )

    @model_validator(mode="after")
    def _check(self) -> Fire:
        check_names(by_index("fuel", self.fuel))
        if self.fds is not None:
            for key in ("fuel", "ignitions"):
                if getattr(self, key):
                    raise wrong(key, "not allowed together with fds, whose fire is already computed")
        else:
            for key in ("fds_ignition_s", "fds_height_m"):
                if (value := getattr(self, key)) != type(self).model_fields[key].default:
                    raise wrong(key, f"{value:g} is only allowed together with fds")
        return self

    @property
    def update_ns(self) -> int:
        """Interval of the updates [ns]."""
        return round(self.update_s * 1e9)

    def burns_through(self, door: Door) -> bool:
        """Whether flames open this door if it is closed. Those of FDS open none."""
        return self.fds is None and self.endures_s(door) is not None

    def endures_s(self, door: Door) -> float | None:
        """Return for how long a closed door resists flames next to it [s]; None: for ever."""
        if door.name in self.fireproof:
            return None
        if door.fire_resistance_min is not None:
            return 60.0 * door.fire_resistance_min
        return None if door.kind == "fireproof" else self.heat.door_endures_s

    def updates_at(self, sim_time_ns: int, step_ns: int) -> bool:
        """Whether fire and smoke advance in the step with this stamp [ns]; never in the first step.

        They do in the first step that begins at a multiple of `update_s` or later.
        """
        return updates(sim_time_ns, step_ns, self.update_ns)


def updates(sim_time_ns: int, step_ns: int, update_ns: int) -> bool:
    """Whether the step with this stamp is the first that begins at a multiple of an interval or later, but not at 0."""
    begin_ns = sim_time_ns - step_ns
    return begin_ns > 0 and begin_ns // update_ns != (begin_ns - step_ns) // update_ns
