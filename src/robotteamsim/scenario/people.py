"""People who move: the model by which they walk, and groups whose members are drawn."""

from __future__ import annotations

import math
from statistics import NormalDist
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from robotteamsim.scenario.base import SMALLEST, Many, Model, Name, by_index, check_names, wrong
from robotteamsim.scenario.victims import Region
from robotteamsim.scenario.yaml_text import shown

_SDS = 3.0
"""A normal distribution without limits ends so many standard deviations from its mean."""


class Uniform(Model):
    """A uniform distribution."""

    kind: Literal["uniform"] = Field(description="uniform")
    min: float = Field(description="least value")
    max: float = Field(description="greatest value")

    @model_validator(mode="after")
    def _check(self) -> Uniform:
        if self.max < self.min:
            raise wrong("max", f"{self.max:g} is below min, {self.min:g}")
        return self

    @property
    def limits(self) -> tuple[float, float]:
        """Least and greatest value."""
        return self.min, self.max

    def quantile(self, share: float) -> float:
        """Return the value that a share of all values, 0 to 1, does not exceed."""
        return self.min + share * (self.max - self.min)


class Normal(Model):
    """A normal distribution between two limits."""

    kind: Literal["normal"] = Field(description="normal")
    mean: float = Field(description="mean, before values beyond the limits are left out")
    sd: float = Field(ge=SMALLEST, le=1e6, description="standard deviation, likewise")
    min: float | None = Field(default=None, description="least value; default: 3 standard deviations below the mean")
    max: float | None = Field(default=None, description="greatest value; default: 3 standard deviations above the mean")

    @model_validator(mode="after")
    def _check(self) -> Normal:
        low, high = self.limits
        if not low < self.mean < high:
            raise wrong("mean", f"{self.mean:g} is not between min, {low:g}, and max, {high:g}")
        return self

    @property
    def limits(self) -> tuple[float, float]:
        """Least and greatest value."""
        low, high = self.mean - _SDS * self.sd, self.mean + _SDS * self.sd
        return low if self.min is None else self.min, high if self.max is None else self.max

    def quantile(self, share: float) -> float:
        """Return the value that a share of all values, 0 to 1, does not exceed."""
        return _truncated(NormalDist(self.mean, self.sd), *self.limits, share)


class Lognormal(Model):
    """A lognormal distribution between two limits."""

    kind: Literal["lognormal"] = Field(description="lognormal")
    mean: float = Field(ge=SMALLEST, le=1e6, description="mean, before values beyond the limits are left out")
    sd: float = Field(ge=SMALLEST, le=1e6, description="standard deviation, likewise")
    min: float = Field(default=0.0, ge=0.0, description="least value")
    max: float | None = Field(
        default=None, description="greatest value; default: that of 3 standard deviations of the logarithm"
    )

    @model_validator(mode="after")
    def _check(self) -> Lognormal:
        low, high = self.limits
        if not low < self._median < high:
            raise wrong("mean", f"the median, {self._median:g}, is not between min, {low:g}, and max, {high:g}")
        return self

    @property
    def _logarithm(self) -> NormalDist:
        variance = math.log1p((self.sd / self.mean) ** 2)
        return NormalDist(math.log(self.mean) - 0.5 * variance, math.sqrt(variance))

    @property
    def _median(self) -> float:
        return math.exp(self._logarithm.mean)

    @property
    def limits(self) -> tuple[float, float]:
        """Least and greatest value."""
        high = math.exp(self._logarithm.mean + _SDS * self._logarithm.stdev)
        return self.min, high if self.max is None else self.max

    def quantile(self, share: float) -> float:
        """Return the value that a share of all values, 0 to 1, does not exceed."""
        low, high = self.limits
        lowest = math.log(low) if low > 0.0 else -math.inf
        return min(max(math.exp(_truncated(self._logarithm, lowest, math.log(high), share)), low), high)


def _truncated(normal: NormalDist, low: float, high: float, share: float) -> float:
    """Return the quantile of a normal distribution without its values outside two limits."""
    below = 0.0 if low == -math.inf else normal.cdf(low)
    at = below + share * (normal.cdf(high) - below)
    return min(max(normal.inv_cdf(at), low), high) if 0.0 < at < 1.0 else (low if at <= 0.0 else high)


def _kind(value: Any) -> str:
    if isinstance(value, dict):
        return f"<{value.get('kind')}>"
    return "<number>" if isinstance(value, (int, float)) else f"<{getattr(value, 'kind', None)}>"


def _check_form(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, (int, float, dict, Model)):
        raise wrong("", f"{shown(value)} is not a number or a distribution, such as {{kind: normal, mean: 1, sd: 0.2}}")
    return value


Distribution = Annotated[
    Annotated[float, Tag("<number>")]
    | Annotated[Uniform, Tag("<uniform>")]
    | Annotated[Normal, Tag("<normal>")]
    | Annotated[Lognormal, Tag("<lognormal>")],
    Discriminator(_kind),
    BeforeValidator(_check_form),
]
"""A number that everybody has, or a distribution from which each person draws."""


def limits(distribution: float | Uniform | Normal | Lognormal) -> tuple[float, float]:
    """Return the least and the greatest value of a distribution."""
    return (distribution, distribution) if isinstance(distribution, (int, float)) else distribution.limits


def quantile(distribution: float | Uniform | Normal | Lognormal, share: float) -> float:
    """Return the value that a share, 0 to 1, of a distribution does not exceed."""
    return float(distribution) if isinstance(distribution, (int, float)) else distribution.quantile(share)


class PeopleGroup(Model):
    """People of one kind: victims <name>_1, <name>_2, ..., whose place, speed and delay `run.seed` draws."""

    name: Name = Field(description="a name, unique among groups")
    count: int = Field(ge=1, le=1000, description="number of people")
    region: Region | None = Field(
        default=None, description="where they are at the start; default: the floor from which an exit can be reached"
    )
    speed_mps: Distribution = Field(
        default=Normal(kind="normal", mean=1.34, sd=0.26),
        description="walking speed: a number, or a distribution of kind uniform, normal or lognormal; default: adults "
        "[weidmann1993] [m/s]",
    )
    flees: bool = Field(default=True, description="whether they walk to the nearest exit that can be reached")
    flees_after_s: Distribution = Field(
        default=0.0, description="until then they stay (reaction, pre-movement time): a number or a distribution [s]"
    )
    can_walk: bool = Field(default=True, description="whether they follow a firefighter, who otherwise carries them")
    calling: bool = Field(default=False, description="whether they call for help")

    @model_validator(mode="after")
    def _check(self) -> PeopleGroup:
        for key, least, most in (("speed_mps", 0.001, 10.0), ("flees_after_s", 0.0, 1e6)):
            low, high = limits(getattr(self, key))
            if low < least or high > most:
                raise wrong(key, f"has values from {low:g} to {high:g}; expected {least:g} to {most:g}")
        return self

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the members."""
        return tuple(f"{self.name}_{number}" for number in range(1, self.count + 1))


class People(Model):
    """Groups of people, and the collision-free speed model of those who flee or follow [tordeux2016]."""

    groups: Many[PeopleGroup] = Field(default=(), max_length=100, description="people whom the seed draws")
    radius_m: float = Field(
        default=0.15, ge=SMALLEST, le=1.0, description="of a person; the length l is twice this [m]"
    )
    time_gap_s: float = Field(default=1.0, gt=0.01, le=10.0, description="T: time to the one ahead [s]")
    neighbour_strength: float = Field(
        default=8.0, ge=0.0, le=1000.0, description="a: how far neighbours turn the direction aside"
    )
    neighbour_range_m: float = Field(default=0.1, ge=0.01, le=10.0, description="D: over which that fades [m]")
    wall_strength: float = Field(default=5.0, ge=0.0, le=1000.0, description="the same of walls")
    wall_range_m: float = Field(default=0.05, ge=0.01, le=10.0, description="over which that fades [m]")
    longest_substep_s: float = Field(default=0.05, ge=0.001, le=1.0, description="of the model in a step [s]")
    look_ahead_m: float = Field(
        default=2.0, gt=0.1, le=100.0, description="how far along the path to an exit people look [m]"
    )
    follow_gap_m: float = Field(
        default=0.8, gt=0.1, le=10.0, description="distance at which people follow a firefighter [m]"
    )

    @model_validator(mode="after")
    def _check(self) -> People:
        check_names(by_index("groups", self.groups))
        return self
