"""Scenarios as Gazebo worlds."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET

import numpy as np
import pytest
import shapely

from robotteamsim.gazebo import export_world
from robotteamsim.scenario import load
from robotteamsim.scenario.plan import door_corners, solids
from robotteamsim.setup import resolve


def _world(text: str) -> ET.Element:
    return ET.fromstring(text).find("world")


def _model(world: ET.Element, name: str) -> ET.Element:
    return next(model for model in world.findall("model") if model.get("name") == name)


def _numbers(element: ET.Element, path: str) -> list[float]:
    return [float(number) for number in element.findtext(path).split()]


def test_robots_are_models_with_the_laser_of_the_scenario_at_their_start_poses():
    scenario = load("garage_sar", ["robots.laser={beams: 91, range_max_m: 8.0, noise_m: 0.02, no_return: inf}"])
    world = _world(export_world(resolve(scenario)).text)
    for i, robot in enumerate(resolve(scenario).robots):
        model = _model(world, f"robot_{i}")
        x, y, yaw = robot.start_pose
        assert _numbers(model, "pose") == pytest.approx([x, y, 0.0, 0.0, 0.0, yaw])
        laser = model.find("link/sensor")
        assert (laser.get("type"), laser.findtext("ray/scan/horizontal/samples")) == ("ray", "91")
        assert _numbers(laser, "ray/scan/horizontal/max_angle") == pytest.approx([math.pi / 2])
        assert _numbers(laser, "ray/range/max") == [8.0]
        assert _numbers(laser, "ray/noise/stddev") == [0.02]
        assert _numbers(laser, "pose") == [0.1, 0.0, 0.25, 0.0, 0.0, 0.0]
        plugin = model.find("plugin")
        assert plugin.get("filename") == "librobotteamsim_gazebo.so"
        settings = {part.tag: part.text for part in plugin if part.tag != "limits"}
        assert settings == {"drive": "velocity", "step_s": "0.1", "cmd_vel_hold_s": "0.8", "no_return": "inf"}


@pytest.mark.parametrize(
    ("drive", "own"),
    [
        ("{kind: differential, max_turn_acceleration_radps2: 7}", {"sideways": "false", "turn_acceleration": "7"}),
        ("{kind: omni}", {"sideways": "true", "turn_acceleration": "8"}),
        ("{kind: car, wheelbase_m: 0.5, max_steering_rad: 0.463647609}", {"sideways": "false", "turning_radius": "1"}),
    ],
)
def test_plugin_has_the_limits_of_the_drive(drive: str, own: dict[str, str]) -> None:
    plugin = _model(_world(export_world(resolve(load("garage_sar", [f"robots.drive={drive}"]))).text), "robot_0").find(
        "plugin"
    )
    limits = {
        part.tag: f"{float(part.text):.3g}" if part.tag != "sideways" else part.text for part in plugin.find("limits")
    }
    common = {"speed": "0.7", "acceleration": "2"}
    assert limits == common | own | {"turn": limits["turn"]}


def test_wheels_are_as_far_apart_as_the_body_allows_and_touch_the_floor():
    world = _world(export_world(resolve(load("garage_sar")), "wheels").text)
    robot = _model(world, "robot_0")
    assert robot.findtext("plugin/drive") == "wheels"
    wheels = [link for link in robot.findall("link") if link.get("name").endswith("_wheel")]
    for wheel, sign in zip(wheels, (1.0, -1.0), strict=True):
        _, y, z = _numbers(wheel, "pose")[:3]
        radius, width = (_numbers(wheel, f"collision/geometry/cylinder/{key}")[0] for key in ("radius", "length"))
        assert z == radius
        assert math.hypot(radius, sign * y + 0.5 * width) < 0.2
    masses = [float(mass.text) for mass in robot.iter("mass")]
    assert sum(masses) == pytest.approx(5.0)


def test_wheels_have_the_radius_and_friction_of_the_scenario():
    scenario = load("garage_sar", ["robots.wheels={radius_m: 0.08, friction: 0.6}"])
    robot = _model(_world(export_world(resolve(scenario), "wheels").text), "robot_0")
    wheel = next(link for link in robot.findall("link") if link.get("name") == "left_wheel")
    assert _numbers(wheel, "collision/geometry/cylinder/radius") == [0.08]
    assert _numbers(wheel, "collision/surface/friction/ode/mu") == [0.6]


def test_only_differential_drives_have_wheels():
    export = export_world(resolve(load("garage_sar", ["robots.drive={kind: omni}"])), "wheels")
    assert _model(_world(export.text), "robot_0").findtext("plugin/drive") == "velocity"
    assert export.notes == (
        "robots.drive: only differential drives have wheels in Gazebo; the others move by their velocity",
    )


def test_robots_that_arrive_later_have_a_file_each():
    export = export_world(resolve(load("garage_sar", ["robots.reserve=1"])))
    names = [model.get("name") for model in _world(export.text).findall("model")]
    assert [name for name in names if name.startswith("robot_")] == ["robot_0", "robot_1"]
    assert list(export.others) == ["robot_2.sdf"]
    assert ET.fromstring(export.others["robot_2.sdf"]).find("model").get("name") == "robot_2"
    assert any("arrive later" in note for note in export.notes)


def _outline(link: ET.Element, x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> tuple[shapely.Polygon, float]:
    """Return what a box or polyline covers on the floor of the world, and the height of its top."""
    collision = link.find("collision")
    poses = [(x, y, 0.0, 0.0, 0.0, yaw)]
    poses += [_numbers(part, "pose") for part in (link, collision) if part.find("pose") is not None]
    box = collision.find("geometry/box/size")
    if box is None:
        polyline = collision.find("geometry/polyline")
        corners = np.array([[float(number) for number in point.text.split()] for point in polyline.findall("point")])
        top_m = float(polyline.findtext("height")) + sum(pose[2] for pose in poses)
    else:
        length_m, width_m, height_m = (float(number) for number in box.text.split())
        corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (0.5 * length_m, 0.5 * width_m)
        top_m = 0.5 * height_m + sum(pose[2] for pose in poses)
    for pose_x, pose_y, _, _, _, turn in reversed(poses):
        cos, sin = math.cos(turn), math.sin(turn)
        corners = corners @ np.array([[cos, sin], [-sin, cos]]) + (pose_x, pose_y)
    return shapely.Polygon(corners), top_m


@pytest.mark.parametrize("name", ["garage_sar", "office_manet", "mrl_arena_mapping", "isr_floor_0_sar"])
def test_walls_blocks_and_closed_doors_have_the_outlines_and_heights_of_the_plan(name: str) -> None:
    scenario = load(name)
    doors = tuple(door.model_copy(update={"closed": True}) for door in scenario.plan.doors)
    plan = scenario.plan.model_copy(update={"doors": doors})
    world = _world(export_world(resolve(scenario.model_copy(update={"plan": plan}))).text)
    found = {
        link.get("name"): _outline(link)
        for model in world.findall("model")
        if model.get("name") in ("robotteamsim_walls", "robotteamsim_blocks", "robotteamsim_pillars")
        for link in model.findall("link")
    }
    fixed = {solid.name: solid for solid in solids(plan) if solid.kind != "door"}
    assert found.keys() == fixed.keys()
    for solid_name, solid in fixed.items():
        outline, top_m = found[solid_name]
        assert shapely.hausdorff_distance(outline, solid.polygon) < 1e-5
        assert top_m == pytest.approx(solid.element.height_m)
    for door in doors:
        model = _model(world, f"door_{door.name}")
        x, y, _, _, _, yaw = _numbers(model, "pose")
        outline, top_m = _outline(model.find("link"), x, y, yaw)
        # The leaf is shorter than the door by a gap of 5 mm at either end.
        assert shapely.hausdorff_distance(outline, shapely.Polygon(door_corners(door))) == pytest.approx(0.005)
        assert top_m == pytest.approx(door.height_m)


@pytest.mark.parametrize("closed", [True, False])
@pytest.mark.parametrize(
    ("motion", "kind", "opens_by"),
    [
        ({"motion": "swing", "angle_rad": -1.2}, "revolute", (0.0, 0.0, -1.2)),
        ({"motion": "slide"}, "prismatic", (-1.1, 0.0, 0.0)),
        ({}, "prismatic", (0.0, 0.0, -100.0)),
    ],
    ids=["swing", "slide", "instant"],
)
def test_joint_of_a_door_moves_the_leaf_between_closed_and_open(motion, kind, opens_by, closed):
    garage = load("garage_sar")
    door = garage.plan.doors[0].model_copy(update={**motion, "closed": closed})
    plan = garage.plan.model_copy(update={"doors": (door,)})
    world = _world(export_world(resolve(garage.model_copy(update={"plan": plan}))).text)
    joint = _model(world, "door_plant_door").find("joint")
    assert (joint.get("type"), joint.findtext("parent")) == (kind, "world")
    axis = _numbers(joint, "axis/xyz")
    lower, upper = (_numbers(joint, f"axis/limit/{key}")[0] for key in ("lower", "upper"))
    travel = next(limit for limit in (lower, upper) if limit != 0.0)
    moved = [travel * part for part in axis]
    assert moved == pytest.approx([part if closed else -part for part in opens_by])
    setting = world.find("plugin/door")
    assert (setting.findtext("model"), setting.findtext("closed")) == ("door_plant_door", str(closed).lower())


def test_open_leaf_is_at_its_open_place():
    garage = load("garage_sar")
    swing = garage.plan.doors[0].model_copy(update={"motion": "swing"})
    slide = garage.plan.doors[1].model_copy(update={"motion": "slide", "closed": False})
    plan = garage.plan.model_copy(update={"doors": (swing, slide)})
    world = _world(export_world(resolve(garage.model_copy(update={"plan": plan}))).text)
    assert _numbers(_model(world, "door_plant_door"), "pose") == pytest.approx([11.9, 36.2, 0, 0, 0, math.pi])
    assert _numbers(_model(world, "door_stair_door"), "pose") == pytest.approx([54.375, 35.8, 0, 0, 0, math.pi / 2])


def test_objects_keep_mass_friction_and_shape():
    objects = (
        "[{name: crate, size_m: [0.6, 0.4], pose: [2.0, 2.0, 0.5], mass_kg: 3.0, friction: 0.4},"
        " {name: drum, kind: barrel, radius_m: 0.3, height_m: 0.9, pose: [4.0, 4.0, 0.0]}]"
    )
    world = _world(export_world(resolve(load("tutorial_arena", [f"objects={objects}"]))).text)
    crate, drum = (_model(world, f"object_{name}").find("link") for name in ("crate", "drum"))
    assert _numbers(crate, "collision/geometry/box/size") == [0.6, 0.4, 0.5]
    assert _numbers(crate, "collision/surface/friction/ode/mu") == [0.4]
    # A box of 3 kg: m (a^2 + b^2) / 12.
    assert _numbers(crate, "inertial/inertia/izz") == pytest.approx([3.0 * (0.36 + 0.16) / 12.0])
    assert _numbers(drum, "collision/geometry/cylinder/radius") == [0.3]
    assert _numbers(drum, "inertial/inertia/izz") == pytest.approx([0.5 * 2.0 * 0.09])


def test_features_that_gazebo_lacks_are_named_in_one_line_each():
    settings = [
        "run.world=mujoco",
        "run.mujoco.lights=[{name: lamp, position: [3.0, 4.0]}]",
        "run.mujoco.ramps=[{from: [4.0, 5.0], to: [6.0, 5.0], height_m: 0.2}]",
        "robots.sensors=[{kind: camera, name: front}, {kind: gps, datum_lat_deg: 40.0, datum_lon_deg: -8.0}]",
        "robots.gripper={}",
    ]
    notes = export_world(resolve(load("tutorial_arena", settings))).notes
    sensors = ("gripper", "sensors")
    assert notes == (
        *(f"robots.{key}: omitted: in Gazebo, robots have only a body and one laser" for key in sensors),
        "run.mujoco.lights: omitted: only in the world of MuJoCo",
        "run.mujoco.ramps: omitted: only in the world of MuJoCo",
    )


def test_steps_of_the_physics_divide_a_step_of_the_scenario():
    world = _world(export_world(resolve(load("garage_sar", ["run.step_s=0.033"]))).text)
    (part_s,) = _numbers(world, "physics/max_step_size")
    assert part_s <= 0.005
    assert 0.033 / part_s == pytest.approx(7.0)
