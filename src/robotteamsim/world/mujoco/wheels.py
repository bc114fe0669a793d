"""The wheels of the three kinds of drives: where they are, and how fast they turn for a speed of the drive.

Wheels are spheres inside the outline of the body, so that each touches the floor in one point and nothing else. A
differential drive has two, and two castors without friction; a car has two driven wheels on its rear axle, with a
differential gear, and two steered ones; an omnidirectional drive has four that roll freely across their driving
direction, as mecanum wheels do.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from robotteamsim.scenario.drives import CarDrive
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.world.mujoco.shapes import WHEEL_GROUP, WHEEL_HITS, WHEEL_PRIORITY

RESPONSE_S = 0.02
"""Time in which a motor takes a wheel to its speed."""

_INSET = 0.8
"""Position of wheels, as a fraction of the way from base_link to the outline."""
_WHEEL_MASS = 0.02
"""Mass of a wheel, as a fraction of the robot's."""
CASTOR = "/castor_"
"""Part of the names of the geoms of castors."""
_CASTOR_LIFT_M = 0.0005
"""Height of castors above the floor, so that the driven wheels carry the robot."""
_HUB_MASS = 0.1
"""Mass of the hub of a steered wheel, as a fraction of the wheel's."""
_STEERING_HZ = 6.0
_DIAGONAL = math.sqrt(0.5)

Gains = tuple[float, float, float, float, float]
"""The target of a motor per forward speed [m/s], turn [rad/s], speed to the left, and steering of the left and of the
right front wheel [rad]."""


@dataclass(frozen=True)
class Chassis:
    """The sizes of a robot's body that its wheels depend on, in base_link [m]."""

    front_m: float
    back_m: float
    half_width_m: float
    wheel_radius_m: float

    @classmethod
    def of(cls, robot: PlacedRobot) -> Chassis:
        """Return the sizes of a robot."""
        corners = robot.corners_m or tuple((s * robot.radius_m, t * robot.radius_m) for s, t in ((1, 1), (-1, -1)))
        half_width_m = min(max(y for _, y in corners), max(-y for _, y in corners))
        radius_m = robot.wheels.radius_m or min(0.25 * half_width_m, 0.4 * robot.height_m)
        return cls(max(x for x, _ in corners), max(-x for x, _ in corners), half_width_m, radius_m)

    @property
    def track_m(self) -> float:
        """Distance from the middle to a wheel on either side."""
        return _INSET * self.half_width_m

    @property
    def clearance_m(self) -> float:
        """Height of the body above the floor."""
        return 0.4 * self.wheel_radius_m


def motor_gains(robot: PlacedRobot) -> list[Gains]:
    """Return the gains of a robot's motors, in the order in which `add_wheels` adds them."""
    chassis = Chassis.of(robot)
    per_m = 1.0 / chassis.wheel_radius_m
    if robot.drive.kind == "car":
        return [(per_m, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 0.0, 1.0)]
    if robot.drive.kind == "differential":
        turn = chassis.track_m * per_m
        return [(per_m, -turn, 0.0, 0.0, 0.0), (per_m, turn, 0.0, 0.0, 0.0)]
    places = _corners_of(chassis)
    return [(per_m * tx, per_m * (ty * x - tx * y), per_m * ty, 0.0, 0.0) for (x, y), (tx, ty) in places]


def steering_rad(middle_rad: np.ndarray, wheelbase_m: np.ndarray, track_m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the angles of the left and the right front wheel for that of a bicycle, after Ackermann."""
    tan = np.tan(middle_rad)
    left_rad = np.arctan2(wheelbase_m * tan, wheelbase_m - track_m * tan)
    return left_rad, np.arctan2(wheelbase_m * tan, wheelbase_m + track_m * tan)


class Motors:
    """The motors of the robots that are present, in the order of the model's actuators."""

    def __init__(self, robots: Sequence[PlacedRobot], present: Sequence[int]) -> None:
        gains = [motor_gains(robots[robot_id]) for robot_id in present]
        self._robot_of = np.array([i for i, some in zip(present, gains, strict=True) for _ in some], dtype=int)
        self._gains = np.array([row for some in gains for row in some]).reshape(-1, 5)
        self._wheelbase_m = np.array([r.drive.wheelbase_m if isinstance(r.drive, CarDrive) else 1.0 for r in robots])
        self._track_m = np.array([Chassis.of(robot).track_m for robot in robots])

    def drive(self, data: mujoco.MjData, speeds: np.ndarray) -> None:
        """Set the targets. Args: speeds: of all drives, shape (n, 4): forward, turn, left, steering."""
        left_rad, right_rad = steering_rad(speeds[:, 3], self._wheelbase_m, self._track_m)
        wanted = np.column_stack((speeds[:, :3], left_rad, right_rad))
        data.ctrl[:] = (self._gains * wanted[self._robot_of]).sum(axis=1)


def add_wheels(spec: mujoco.MjSpec, body: Any, name: str, robot: PlacedRobot) -> None:
    """Add wheels and motors to the body of a robot in the spec."""
    add = {"differential": _add_differential, "omni": _add_omni, "car": _add_car}[robot.drive.kind]
    add(spec, body, name, robot, Chassis.of(robot))


def wheel_mass_kg(robot: PlacedRobot) -> float:
    """Return the mass of all wheels and of the hubs that steer."""
    wheels = {"differential": 2.0, "omni": 4.0, "car": 4.0 + 2.0 * _HUB_MASS}[robot.drive.kind]
    return _WHEEL_MASS * robot.mass_kg * wheels


def _add_differential(spec: mujoco.MjSpec, body: Any, name: str, robot: PlacedRobot, chassis: Chassis) -> None:
    gain = 0.5 * robot.mass_kg * chassis.wheel_radius_m**2 / RESPONSE_S
    for side, y_m in (("left", chassis.track_m), ("right", -chassis.track_m)):
        joint = _add_rolling(body, f"{name}/wheel_{side}", [0.0, y_m, chassis.wheel_radius_m], robot, chassis)
        _add_motor(spec, joint, gain)
    radius_m = 0.5 * chassis.wheel_radius_m
    for end, x_m in (("front", chassis.front_m), ("back", -chassis.back_m)):
        body.add_geom(
            name=f"{name}{CASTOR}{end}",
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=[radius_m, 0.0, 0.0],
            pos=[_INSET * x_m, 0.0, radius_m + _CASTOR_LIFT_M],
            condim=1,
            **_wheel_keys(robot),
        )


def _add_car(spec: mujoco.MjSpec, body: Any, name: str, robot: PlacedRobot, chassis: Chassis) -> None:
    assert isinstance(robot.drive, CarDrive)
    radius_m, sides = chassis.wheel_radius_m, (("left", chassis.track_m), ("right", -chassis.track_m))
    axle = spec.add_tendon(name=f"{name}/axle")
    for side, y_m in sides:
        joint = _add_rolling(body, f"{name}/wheel_{side}", [0.0, y_m, radius_m], robot, chassis)
        axle.wrap_joint(joint, 0.5)  # a differential gear: the mean of both wheels
    motor = spec.add_actuator(name=f"{name}/axle", trntype=mujoco.mjtTrn.mjTRN_TENDON, target=axle.name)
    motor.set_to_velocity(kv=robot.mass_kg * radius_m**2 / RESPONSE_S)
    mass_kg = _WHEEL_MASS * robot.mass_kg
    inertia = 0.5 * mass_kg * radius_m**2
    for side, y_m in sides:
        hub = body.add_body(name=f"{name}/hub_{side}", pos=[robot.drive.wheelbase_m, y_m, radius_m])
        hub.mass, hub.ipos, hub.inertia = _HUB_MASS * mass_kg, [0.0, 0.0, 0.0], [inertia] * 3
        hub.explicitinertial = True
        joint = hub.add_joint(name=f"{name}/steering_{side}", type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0.0, 0.0, 1.0])
        _add_rolling(hub, f"{name}/front_{side}", [0.0, 0.0, 0.0], robot, chassis)
        motor = spec.add_actuator(name=joint.name, trntype=mujoco.mjtTrn.mjTRN_JOINT, target=joint.name)
        turning = 2.0 * math.pi * _STEERING_HZ
        motor.set_to_position(kp=2.0 * inertia * turning**2, kv=4.0 * inertia * turning)


def _add_omni(spec: mujoco.MjSpec, body: Any, name: str, robot: PlacedRobot, chassis: Chassis) -> None:
    gain = 0.5 * robot.mass_kg * chassis.wheel_radius_m**2 / RESPONSE_S
    for index, ((x_m, y_m), (tx, ty)) in enumerate(_corners_of(chassis)):
        wheel, place = f"{name}/wheel_{index}", [x_m, y_m, chassis.wheel_radius_m]
        body.add_site(name=f"{wheel}/mount", pos=place)
        hub = body.add_body(name=wheel, pos=place)
        hub.add_joint(name=wheel, type=mujoco.mjtJoint.mjJNT_BALL)
        hub.add_site(name=wheel)
        _add_tyre(hub, wheel, robot, chassis)
        motor = spec.add_actuator(name=wheel, trntype=mujoco.mjtTrn.mjTRN_SITE, target=wheel, refsite=f"{wheel}/mount")
        motor.gear = [0.0, 0.0, 0.0, -ty, tx, 0.0]  # about the axle, which is fixed in the body; free across it
        motor.set_to_velocity(kv=gain)


def _corners_of(chassis: Chassis) -> Sequence[tuple[tuple[float, float], tuple[float, float]]]:
    """Return place and driving direction of four wheels that roll towards each other in pairs."""
    front_m, back_m, side_m = _INSET * chassis.front_m, _INSET * chassis.back_m, chassis.track_m
    if front_m == back_m == side_m:  # a disc contains the corners of a smaller square
        front_m = back_m = side_m = _DIAGONAL * side_m
    places = ((front_m, side_m), (front_m, -side_m), (-back_m, side_m), (-back_m, -side_m))
    ways = ((_DIAGONAL, -_DIAGONAL), (_DIAGONAL, _DIAGONAL), (_DIAGONAL, _DIAGONAL), (_DIAGONAL, -_DIAGONAL))
    return tuple(zip(places, ways, strict=True))


def _add_rolling(body: Any, name: str, place: list[float], robot: PlacedRobot, chassis: Chassis) -> str:
    """Add a wheel on an axle from right to left; return the name of its joint."""
    wheel = body.add_body(name=name, pos=place)
    wheel.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0.0, 1.0, 0.0])
    _add_tyre(wheel, name, robot, chassis)
    return name


def _add_tyre(wheel: Any, name: str, robot: PlacedRobot, chassis: Chassis) -> None:
    wheel.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_SPHERE,
        size=[chassis.wheel_radius_m, 0.0, 0.0],
        mass=_WHEEL_MASS * robot.mass_kg,
        **_wheel_keys(robot),
    )


def _wheel_keys(robot: PlacedRobot) -> dict[str, Any]:
    return {
        "contype": 0,
        "conaffinity": WHEEL_HITS,
        "group": WHEEL_GROUP,
        "priority": WHEEL_PRIORITY,
        "friction": [robot.wheels.friction, 0.0, 0.0],
        "rgba": [0.1, 0.1, 0.1, 1.0],
    }


def _add_motor(spec: mujoco.MjSpec, joint: str, gain: float) -> None:
    motor = spec.add_actuator(name=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT, target=joint)
    motor.set_to_velocity(kv=gain)
