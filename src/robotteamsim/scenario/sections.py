"""The sections of a scenario. Default, unit, range and meaning of every key are defined here and nowhere else."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from robotteamsim.scenario.base import (
    SMALLEST,
    Interval,
    LossDb,
    Many,
    Model,
    Name,
    NoiseDb,
    PlanarPose,
    Point,
    by_index,
    check_names,
    wrong,
)
from robotteamsim.scenario.body import Body, check_footprint, disc_at, polygon_at
from robotteamsim.scenario.controllers.cover import FloorSearchTuning
from robotteamsim.scenario.drives import AnyDrive, Drive
from robotteamsim.scenario.mujoco import Gripper, Mujoco, Wheels
from robotteamsim.scenario.patrol import Patrol
from robotteamsim.scenario.plan import Corners, counter_clockwise
from robotteamsim.scenario.radio_presets import with_preset
from robotteamsim.scenario.rescue import Exit, Rescue
from robotteamsim.scenario.sensors import AnySensor
from robotteamsim.scenario.sensors import Laser as Laser
from robotteamsim.scenario.victims import Victim as Victim
from robotteamsim.scenario.worlds import WorldName

LARGEST_AREA_M = 100.0
"""Radius of the largest area [m]."""

ConstantDb = Annotated[float, Field(ge=-200.0, le=200.0)]
Exponent = Annotated[float, Field(ge=0.1, le=20.0)]


class Radio(Model):
    """The multi-wall radio model [dissertation, eq. 2-4 and Table 3]; rssi = tx power - path loss."""

    preset: Literal["none", "wifi_2_4_ghz", "wifi_5_ghz", "zigbee", "lora_868_mhz"] = Field(
        default="none",
        description="defaults of tx_power_dbm, constant_loss_db and thresholds in `network`; explicit keys override",
    )
    tx_power_dbm: float = Field(default=0.0, ge=-40.0, le=40.0, description="transmit power [dBm]")
    constant_loss_db: float = Field(default=47.4, ge=0.0, le=120.0, description="l0 + l_c [dB]")
    slope_db: float = Field(default=23.2, ge=SMALLEST, le=80.0, description="10*gamma: loss per tenfold distance [dB]")
    wall_loss_db: Many[LossDb] = Field(
        default=(3.8, 3.9, 5.7, 12.4),
        min_length=4,
        max_length=4,
        description="walls of thickness [0,20], ]20,40], ]40,60], ]60,80] cm; multiples of 0.1 [dB]",
    )
    door_loss_db: LossDb = Field(default=1.4, description="closed normal door [dB]")
    fireproof_door_loss_db: LossDb = Field(default=10.2, description="closed fireproof door [dB]")
    walls: Literal["published", "material"] = Field(
        default="published",
        description="loss of walls of the plan's materials: by thickness (Table 3), or of their layers [itu_p2040]",
    )
    frequency_mhz: float = Field(default=2450.0, ge=400.0, le=40_000.0, description="for `walls: material` [MHz]")
    materials: dict[str, LossDb] = Field(
        default={}, description="loss of walls by material name, before all others [dB]"
    )
    pillars: bool = Field(default=True, description="whether pillars attenuate radio")
    min_distance_m: float = Field(default=0.1, ge=SMALLEST, le=1.0, description="shorter distances count as this [m]")
    floor_loss_db: float = Field(default=18.3, ge=0.0, le=120.0, description="L_f: the first floor crossed [dB]")
    floor_exponent: float = Field(
        default=0.46, ge=0.0, le=2.0, description="b: k floors cost k^((k+2)/(k+1) - b) times L_f"
    )

    @model_validator(mode="before")
    @classmethod
    def _apply_preset(cls, data: Any) -> Any:
        return with_preset("radio", data, data.get("preset")) if isinstance(data, dict) else data


class Voice(Model):
    """A victim's voice [dissertation, eq. 7]: level = -l_c - 10*gamma*log10(d) - sum of walls."""

    noise_db: NoiseDb = Field(default=10.0, description="background noise; below it the level is 0 [dB]")
    constant_db: Interval[ConstantDb] = Field(
        default=(-78.0, -72.0), description="l_c is drawn from this range per victim [dB]"
    )
    exponent: Interval[Exponent] = Field(
        default=(5.0, 6.0), description="gamma is drawn from this range per victim; 2 in free field"
    )
    wall_model: Literal["count", "thickness", "material"] = Field(
        default="count",
        description="loss per wall: the same for all (eq. 6), by thickness (eq. 5), or by the mass of its material",
    )
    wall_loss_db: LossDb = Field(
        default=2.0, description="l_w, any wall or closed door, for `count`; for `material` those without one [dB]"
    )
    frequency_hz: float = Field(default=500.0, ge=100.0, le=4000.0, description="of speech, for `material` [Hz]")
    attenuation_per_cm: float = Field(
        default=0.0115, ge=0.0, le=1.0, description="mu, for `thickness`; concrete has 0.01 .. 0.035 [1/cm]"
    )
    floor_loss_db: LossDb = Field(default=40.0, description="each floor between two levels [dB]")
    min_distance_m: float = Field(default=0.1, ge=SMALLEST, le=1.0, description="shorter distances count as this [m]")
    map_resolution_m: float = Field(default=0.25, ge=0.05, le=2.0, description="cell of the voice map [m]")
    local_best_radius_m: float = Field(
        default=1.5, ge=SMALLEST, le=20.0, description="radius within which a robot perceives the voice map [m]"
    )

    @model_validator(mode="after")
    def _check(self) -> Voice:
        for key, (low, high) in (("constant_db", self.constant_db), ("exponent", self.exponent)):
            if low > high:
                raise wrong(key, f"[{low:g}, {high:g}] is not in the order low, high")
        return self


class Odometry(Model):
    """Drift of the odometry relative to the true motion; with zero alphas it is exact.

    The variances are those of motions of 0.1 s; a drive has the same drift whatever `run.step_s` is.
    """

    alpha1: float = Field(
        default=0.01, ge=0.0, le=10.0, description="turn noise per turn, of motions of 0.1 s [rad^2/rad^2]"
    )
    alpha2: float = Field(default=0.001, ge=0.0, le=10.0, description="turn noise per distance [rad^2/m^2]")
    alpha3: float = Field(default=0.001, ge=0.0, le=10.0, description="distance noise per distance [m^2/m^2]")
    alpha4: float = Field(default=0.0001, ge=0.0, le=10.0, description="distance noise per turn [m^2/rad^2]")


class Robot(Model):
    """The body, drive and sensors of a robot."""

    radius_m: float = Field(default=0.2, gt=0.02, le=5.0, description="of a round body; unused with footprint_m [m]")
    footprint_m: Many[Point] = Field(
        default=(), description="convex body: 3 to 8 corners in order around base_link, in its frame [m]"
    )
    height_m: float = Field(default=0.25, ge=SMALLEST, le=5.0, description="for 3D views [m]")
    mass_kg: float = Field(default=5.0, ge=SMALLEST, le=10_000.0, description="for pushing [kg]")
    drive: AnyDrive = Field(default=Drive(), description="differential, omni or car")
    wheels: Wheels = Wheels()
    laser: Laser = Laser()
    sensors: Many[AnySensor] = Field(
        default=(), max_length=128, description="additional sensors, each with a `kind` and its own topic"
    )
    gripper: Gripper | None = Field(default=None, description="lifts objects; only in `run.world: mujoco`")
    odometry: Odometry = Odometry()
    cmd_vel_hold_s: float = Field(
        default=0.8, ge=SMALLEST, le=60.0, description="time for which the last command holds [s]"
    )

    @model_validator(mode="after")
    def _check_body(self) -> Robot:
        check_names(by_index("sensors", self.sensors), "sensor")
        if self.footprint_m:
            check_footprint("footprint_m", self.footprint_m)
        if self.wheels.radius_m is not None and self.wheels.radius_m > self.height_m:
            raise wrong("wheels.radius_m", f"{self.wheels.radius_m:g} is above height_m, {self.height_m:g}")
        return self

    @property
    def corners_m(self) -> Corners:
        """The footprint counter-clockwise in base_link [m]; empty: the body is round."""
        return counter_clockwise(self.footprint_m) if self.footprint_m else ()

    @property
    def reach_m(self) -> float:
        """Radius of the smallest disc around base_link that contains the body [m]."""
        return max((math.hypot(x, y) for x, y in self.footprint_m), default=self.radius_m)

    def body_at(self, pose: PlanarPose) -> Body:
        """Return the body of a robot at a pose."""
        return polygon_at(self.corners_m, pose) if self.footprint_m else disc_at(self.radius_m, pose)


class PlacedRobot(Robot):
    """One robot of a list of robots."""

    start_pose: PlanarPose = Field(description="[x, y, yaw] in the map frame [m, m, rad]")
    present: bool = Field(default=True, description="whether it is present at the start, or arrives later")


class Team(Robot):
    """A team of equal robots: `count` of them from a formation around `start`, or from `start_poses`."""

    count: int = Field(default=3, ge=0, le=3000, description="number of robots; 0 only with firefighters or exits")
    reserve: int = Field(
        default=0,
        ge=0,
        le=2999,
        description="number of robots, the last ones, that are absent at the start and arrive later",
    )
    start: PlanarPose | None = Field(default=None, description="centre and heading of the formation [m, m, rad]")
    spacing_m: float = Field(default=0.8, ge=SMALLEST, le=20.0, description="between neighbours in the formation [m]")
    formation: Literal["square", "spiral", "random"] = Field(
        default="square",
        description="a square grid; the spiral of Theodorus with spacing_m between successive robots; or poses that "
        "`run.seed` draws uniformly from the floor that can be reached from the start, at least spacing_m apart",
    )
    start_poses: Many[PlanarPose] = Field(default=(), description="one pose per robot, in id order")

    @model_validator(mode="after")
    def _check(self) -> Team:
        if self.count and self.start is None and not self.start_poses:
            raise wrong("start", "missing; expected [x, y, yaw], or start_poses instead")
        if self.reserve and self.reserve >= self.count:
            raise wrong("reserve", f"{self.reserve} leaves none of {self.count} robots at the start")
        if self.spacing_m < 2.0 * self.reach_m:
            raise wrong("spacing_m", f"{self.spacing_m:g} is below two radii, {2.0 * self.reach_m:g}")
        return self


class Network(Model):
    """Which robots are linked, and how messages travel."""

    endangered_below_dbm: float = Field(
        default=-80.0, ge=-200.0, le=20.0, description="a weaker link is endangered [dBm]"
    )
    lost_below_dbm: float = Field(default=-94.0, ge=-200.0, le=20.0, description="a weaker link does not exist [dBm]")
    link: Literal["signal", "distance"] = Field(
        default="signal", description="whether links depend on signal or distance (eq. 16)"
    )
    max_distance_m: float = Field(
        default=25.0, ge=SMALLEST, le=10_000.0, description="d_max, for links by distance [m]"
    )
    hop_delay_s: float = Field(
        default=0.0,
        ge=0.0,
        le=60.0,
        description="time per hop; a message always arrives in a later step than the one it was sent in [s]",
    )
    loss: Literal["none", "signal"] = Field(
        default="none",
        description="none: no message is lost on a link; signal: with a probability from 0 at endangered_below_dbm to "
        "1 at lost_below_dbm, per hop",
    )
    max_message_bytes: int = Field(
        default=65_507,
        ge=1,
        le=2**31 - 1,
        description="larger messages are not sent; default: the largest UDP datagram",
    )
    publish_matrices: bool = Field(
        default=True,
        description="whether ROS runs and bags have /network/state, with all matrices, besides /network/links; false "
        "for large teams: a message for 1000 robots has 30 MB",
    )

    @model_validator(mode="after")
    def _check(self) -> Network:
        if self.endangered_below_dbm < self.lost_below_dbm:
            raise wrong(
                "endangered_below_dbm",
                f"{self.endangered_below_dbm:g} is below lost_below_dbm, {self.lost_below_dbm:g}",
            )
        return self


class Area(Model):
    """A circle to explore."""

    name: Name = Field(description="a name, unique among areas")
    center: Point = Field(description="[x, y] in the map frame [m]")
    radius_m: float = Field(
        default=2.0, ge=SMALLEST, le=LARGEST_AREA_M, description="explored when a robot is within this distance [m]"
    )


class Coverage(Model):
    """What counts as covered. The mission reports which share of the floor it is."""

    radius_m: float = Field(
        default=FloorSearchTuning().radius_m,
        ge=SMALLEST,
        le=50.0,
        description="floor is covered once a robot was within this distance of it and saw it [m]",
    )


class Mission(Model):
    """What the team has to do and when the mission ends [dissertation, 5.3]."""

    areas: Many[Area] = Field(
        default=(), description="explored in this order, unless area_order; those that no robot can reach come last"
    )
    area_order: Literal["given", "nearest", "sebs", "search"] = Field(
        default="given",
        description="given: in the order of the list; else each robot chooses its next area and shares it over the "
        "network: nearest, by its path; sebs, by the posterior of SEBS; search, where it expects most victims for the "
        "time, only with control.algorithm search",
    )
    victims: Many[Victim] = Field(default=(), description="victims")
    random_victims: int = Field(
        default=0,
        ge=0,
        le=1000,
        description="number of further victims, random_1, random_2, ..., at places that `run.seed` draws uniformly "
        "from the floor that robots can reach",
    )
    walk_update_s: float = Field(
        default=1.0, ge=0.05, le=60.0, description="victims who move, and their voices, do so at this interval [s]"
    )
    save_distance_m: float = Field(
        default=1.0,
        ge=SMALLEST,
        le=20.0,
        description="a robot, or firefighter, within this distance reaches a victim [m]",
    )
    saved_by: Literal["robot", "firefighter"] = Field(
        default="robot",
        description="robot: whoever is reached is saved; firefighter: who is brought to the command centre or an exit",
    )
    rescue: Rescue = Rescue()
    patrol: Patrol = Patrol()
    coverage: Coverage | None = Field(default=None, description="with it, missions report the floor covered")
    exits: Many[Exit] = Field(default=(), description="places where people are safe")
    time_limit_s: float = Field(default=600.0, ge=SMALLEST, le=1e6, description="the mission ends after this time [s]")
    base: int | None = Field(
        default=None,
        ge=0,
        le=2999,
        description="id of a robot that stands still and must receive each discovery over the network",
    )
    autostart: bool = Field(default=True, description="false: wait for /mission/start")

    @model_validator(mode="after")
    def _check(self) -> Mission:
        for key, items in (("areas", self.areas), ("victims", self.victims), ("exits", self.exits)):
            check_names(by_index(key, items))
        random = {f"random_{number}" for number in range(1, self.random_victims + 1)}
        for index, victim in enumerate(self.victims):
            if victim.name in random:
                raise wrong(f"victims.{index}.name", f"'{victim.name}' is the name of a victim of random_victims")
        return self


class Run(Model):
    """How time passes."""

    seed: int = Field(default=1, ge=0, le=2**53, description="of every random stream")
    step_s: float = Field(default=0.1, ge=0.001, le=1.0, description="one step of the loop: sensors, commands [s]")
    physics_substeps: int = Field(
        default=5, ge=1, le=1000, description="physics steps and clock ticks per step; ROS wants 50 Hz"
    )
    map_resolution_m: float = Field(
        default=0.05, ge=0.01, le=2.0, description="cell of /map, unless the plan is a map of map_server [m]"
    )
    world: WorldName = Field(
        default="box2d",
        description="what moves the robots: box2d, in the plane; mujoco, in three dimensions, with wheels that slip; "
        "or a world of a package",
    )
    mujoco: Mujoco = Mujoco()

    @model_validator(mode="after")
    def _check(self) -> Run:
        if abs(self.step_s * 1e9 - self.step_ns) > 1e-3:
            raise wrong("step_s", f"{self.step_s!r} is not a whole number of nanoseconds")
        if self.step_ns % self.physics_substeps:
            raise wrong("physics_substeps", f"{self.physics_substeps} does not divide step_s, {self.step_ns} ns")
        return self

    @property
    def step_ns(self) -> int:
        """One step of the loop [ns]."""
        return round(self.step_s * 1e9)
