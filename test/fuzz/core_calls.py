"""Valid calls of every public function and method of `robotteamsim._core`."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from typing import Any

import numpy as np
from call_trees import Call, Output, new
from map_calls import map_calls

from robotteamsim import _core
from robotteamsim.geometry import Pose, PoseReading, Twist
from robotteamsim.sensing.readings import OdometryReading, RobotReading, VoiceReading

_CELLS = np.zeros((8, 12), np.bool_)
_CELLS[3, 2:9] = True
_GRID = new("plan.PlanningGrid", _CELLS, (-1.0, 2.0), 0.5, 0.3, [((-0.6, 2.4), (4.2, 5.6), 3.0)])
_FROM, _TO, _SOLID = (-0.6, 2.4), (4.2, 5.6), (1.0, 3.7)
_MAP = np.linspace(0.0, 5.0, 96, dtype=np.float32).reshape(8, 12)


def _of(made: Call, *methods: tuple[Any, ...]) -> Iterator[Call]:
    for method in methods:
        yield made.of(method)


def _plan() -> Iterator[Call]:
    yield new("base.hypot", np.array([3.0]), np.array([4.0]))
    yield new("base.nearest_point", (1.0, 2.0), [(3.0, 4.0), (5.0, 6.0)])
    yield new("base.nearest_other", (1.0, 2.0), np.array([(3.0, 4.0), (5.0, 6.0)]), 0)
    yield new("base.Places", [(3.0, 4.0)], [5.0]).of(("reached", np.array([[1.0, 2.0]])))
    yield from _of(
        _GRID,
        ("blocked",),
        ("is_free", _FROM),
        ("nearest_free", _SOLID, 3.0),
        ("is_line_free", _FROM, (4.2, 2.7)),
        ("distance_map", _TO),
        ("value_at", _MAP, _FROM),
        ("values_near", _MAP, np.array([_FROM, _TO]), 1.0),
        ("shortest_path", _FROM, _TO, 20.0),
        ("waypoints", _FROM, _TO, 20.0),
        ("first_stretch", _FROM, _TO, 20.0),
        ("along_path", _FROM, _TO, 20.0),
        ("least_reachable", _MAP, _FROM, 2.0),
        ("descend", _MAP, _FROM, 2.0),
        ("nearest_reachable", _FROM, _TO, 2.0),
        ("reachable_towards", _FROM, _TO),
        ("nearest_in_disc", _SOLID, _TO, 3.0),
    )


_LAYOUT = new(
    "control.LaserLayout", beams=5, angle_min_rad=-1.5, angle_max_rad=1.5, forward_m=0.1, range_max_m=5.0, left_m=0.0
)
_PARAMETERS = new(
    "control.NavigatorParameters",
    **dict.fromkeys(("arrived_m", "laser_margin_m", "look_ahead_m", "turn_in_place_rad", "turn_gain_per_s"), 0.5),
    **dict.fromkeys(("braking_mps2", "manoeuvring_mps", "room_to_turn_m", "progress_m", "yield_timeout_s"), 0.5),
    **dict.fromkeys(("escape_m", "near_teammate_m", "nearest_free_start_m", "nearest_free_goal_m"), 0.7),
    **dict.fromkeys(("sidestep_left_penalty", "sidestep_change_penalty", "sidestep_ahead_rad"), 0.3),
    longest_path_m=50.0,
    stuck_timeout_s=1.0,
    escape_time_s=4.0,
    escape_headings=16,
)
_SCAN = np.array([1.0, 2.0, 0.4, 2.0, 5.0], np.float32)


_ODD_M = np.array([(math.nan, math.inf), (1e308, -1e308), (0.0, 2.4)])


class Teammates:
    """Where a navigator's teammates are; the places are leaves of no tree, so they are odd already."""

    def __call__(self) -> Any:
        return _core.control.Places(np.array([0, 3, 5], np.int32), _ODD_M)


def _control() -> Iterator[Call]:
    yield new("control.Places", np.array([0, 3], np.int32), np.array([(1.0, 2.0), (3.0, 4.0)]))
    for by_path in (True, False):
        navigator = new(
            "control.Navigator",
            robot_id=4,
            radius_m=0.2,
            laser=_LAYOUT,
            max_speed_mps=0.7,
            max_turn_radps=2.0,
            is_car=by_path,
            by_path=by_path,
            parameters=_PARAMETERS,
        )
        drive = ("drive", _GRID, Pose(-0.6, 2.4, 0.3), _SCAN, _TO, 0.5)
        yield navigator.of((*drive, 0, Teammates()), (*drive, 2_000_000_000, Teammates()))
        state = new("state.State", 2, 5).of(*(("place", robot_id, Pose(-0.6, 2.4, 0.3)) for robot_id in (0, 1)))
        yield new("control.drive_team", state, [(1, navigator, _GRID, _TO, 0.5, Teammates(), 10)], 0)
    surroundings = new(
        "control.Surroundings", laser=_LAYOUT, stride=1, sensing_radius_m=3.0, headings_rad=[-1.0, 0.0, 1.0]
    )
    yield surroundings.of(("clearest_place", Pose(1.0, 2.0, 0.3), _SCAN))
    heard = new("control.HeardNotes", [((1.0, 2.0), (3.0, 4.0)), ((5.0, 6.0), None)])
    yield heard.of(("notes",))
    ruled_out = new("control.RuledOut", radius_m=2.0, cell_m=0.5, next_to_m=0.4)
    yield ruled_out.of(
        ("add", (1.0, 2.0), (3.0, 4.0)), ("add_all", heard), ("covers", (1.1, 2.1)), ("clear",), ("covers", (1.0, 2.0))
    )
    cells, rays = (
        np.array([[0, -1, 100], [-1, -1, 0]], np.int8),
        np.array([[(0, 1), (0, 2)], [(1, 0), (1, 1)]], np.int32),
    )
    yield new("control.unknown_in_view", cells, np.array([(0, 0), (1, 2)], np.int32), rays, np.array([0.1, 0.2]))
    yield new("swarm.next_velocity", (1.0, 2.0), (0.1, 0.2), [(1.0, 2.0)] * 4, [0.5] * 4, [0.3] * 4)
    yield new("swarm.memory_term", [0.5, 0.2], [(1.0, 2.0), (3.0, 4.0)])


_FACES = new("propagation.FaceSet", [(1000, 0, 1000, 3000), (2000, 3000, 4000, 3000)], [20, 40])
_LEVELS = [
    new(
        "propagation.Storey",
        least_mm=(x_mm, -1000),
        most_mm=(x_mm + 2200, 6000),
        origin_mm=(x_mm, 0),
        floor_mm=floor_mm,
        ceiling_mm=floor_mm + 2500,
        floor_weight=weight,
        openings_mm=[[(x_mm, 0), (x_mm + 900, 0), (x_mm, 800)]],
    )
    for x_mm, floor_mm, weight in ((-100, 0, -1), (2200, 3000, 290), (4500, 7000, -1))
]
_BUILDING = new("propagation.FaceSet", [(1000, 0, 1000, 3000), (2500, 3000, 4000, 3000)], [20, 40], _LEVELS)
_CELL_GRID = {"origin_m": (-1.0, 2.0), "cell_m": 1.0, "rows": 4, "columns": 6}
_LOSSES = new(
    "control.VoiceLosses",
    faces=_FACES,
    **_CELL_GRID,
    slope_db=55.0,
    wall_unit_db=1.0,
    min_distance_m=0.1,
    nearer_m=1.4,
    step_db=0.3,
)
_CELL_PATHS = new("control.CellPaths", grid=_GRID, **_CELL_GRID, kept_out=((3.0, 3.0), 0.8))
_PRIOR = np.linspace(0.1, 1.0, 24, dtype=np.float32)


def _search() -> Iterator[Call]:
    yield from _of(_LOSSES, ("losses_from", 3))
    yield from _of(
        _CELL_PATHS,
        ("cell_of", _FROM),
        ("start_of", _FROM),
        ("place_of", 3),
        ("lengths_from", 3),
        ("length_m", 3, 7),
        ("ahead", _FROM, 7, 5.0),
        ("way_within", _FROM, np.ones(24, dtype=bool), np.ones(24, dtype=bool), 5.0),
    )
    belief = new("control.VictimBelief", _LOSSES, _PRIOR)
    unheard = ("set_unheard", np.linspace(0.0, 1.0, 256, dtype=np.float32))
    listened = ("listen", 3, 2)
    yield belief.of(unheard, listened, ("set_losses", _LOSSES), ("remaining",), ("mass",))
    yield belief.of(unheard, listened, ("best", _CELL_PATHS, 3, [7, 9], [1], 0.5, 2.0))
    yield belief.of(unheard, listened, ("worth", _CELL_PATHS, 3, 7, [1], 0.5, 2.0))
    fix = new("control.VoiceFix", _LOSSES, (75.0, 1.7), (5.5, 0.3))
    yield fix.of(("add", _FROM, 50.0), ("count",), ("most_probable", _PRIOR))


_RADIO = new(
    "propagation.RadioModel",
    tx_power_dbm=0.0,
    constant_loss_db=42.7,
    slope_db=26.2,
    min_distance_m=0.1,
    floor_loss_db=18.3,
    floor_exponent=0.46,
)
_VOICE = new("propagation.VoiceModel", noise_db=20.0, unit_db=3.0, min_distance_m=0.1)
_CALLER = new("propagation.VoiceSource", (1.5, 2.0), -80.0, 2.0)
_TEAM = np.array([[0.0, 1.0], [2.0, 1.0], [3.0, 4.0]])
_ORIGIN, _RESOLUTION_M, _CELLS_OUT = (0.0, 0.0), 0.5, Output((6, 8))
_LINK_RULE = {"by_distance": False, "lost_below_dbm": -94.0, "max_distance_m": 25.0, "endangered_below_dbm": -80.0}
_LINKED = np.array([[False, True], [True, False]])


def _signals() -> Iterator[Call]:
    yield _FACES.of(("weight_between", (0.0, 1.0), (4.0, 1.0)), ("set_active", 0, False))
    yield new("propagation.path_loss_db", _FACES, _RADIO, (0.0, 1.0), (3.0, 1.0), 2)
    yield new("propagation.rssi_matrix_dbm", _FACES, _RADIO, _TEAM)
    yield new("propagation.rssi_matrix_dbm", _FACES, _RADIO, np.tile(_TEAM, (4, 1)))
    yield new("propagation.path_loss_db", _BUILDING, _RADIO, (0.0, 1.0), (5.0, 1.0))
    yield new("propagation.rssi_matrix_dbm", _BUILDING, _RADIO, np.tile(2.0 * _TEAM, (4, 1)))
    solid = np.zeros((6, 8), np.bool_)
    for faces in (_FACES, _BUILDING):
        radio = (faces, _RADIO, [(0.2, 0.3), (3.0, 2.0)], 1, _ORIGIN, _RESOLUTION_M)
        yield new("propagation.write_best_rssi_map_dbm", *radio, _CELLS_OUT, 1)
        yield new("propagation.write_rssi_maps_dbm", *radio, Output((12, 8)), 1)
        yield new("propagation.voice_level_db", faces, _VOICE, _CALLER, (3.0, 2.0))
        voices = (faces, _VOICE, [_CALLER], _ORIGIN, _RESOLUTION_M, solid, _CELLS_OUT, 1)
        yield new("propagation.write_voice_map_db", *voices)
    yield new("network.hop_count", _LINKED)
    yield new("network.fiedler_value", _LINKED)
    links = new("network.TeamLinks", _FACES, _RADIO, **_LINK_RULE | {"by_distance": True})
    team = new("state.State", 3).of(*(("place", i, Pose(*place, 0.0)) for i, place in enumerate(_TEAM.tolist())))
    yield links.of(("step", team))
    some = np.full((3, 3), -60.0), np.ones((3, 3), np.bool_), np.zeros((3, 3), np.bool_), np.ones((3, 3), np.int32)
    matrices = ("rssi_dbm", "link", "adjacency", "endangered", "hop_count", "fiedler_value", "links_version")
    yield team.of(("put_links", *some, 2.0, 1), *((name,) for name in matrices), ("of", 0))


def _box(x: float, y: float, side: float) -> list[tuple[float, float]]:
    return [(x, y), (x + side, y), (x + side, y + side), (x, y + side)]


_WALL = new("world.Solid", _box(2.0, -1.0, 2.0), [_box(2.0, -1.0, 2.0)])
_LEAF = new("world.Solid", _box(-3.0, 2.0, 0.5), [_box(-3.0, 2.0, 0.5)])
_INSTANT = new("world.Door", _LEAF, True)
_DOOR = new("world.Door", _LEAF, True, time_s=2.0, angle_rad=1.5, shift_m=(0.1, 0.0), hinge_m=(-3.0, 2.0))
_WHEELS = new(
    "world.Drive",
    kind="differential",
    max_speed_mps=0.7,
    max_acceleration_mps2=1.0,
    max_turn_radps=2.0,
    max_turn_acceleration_radps2=4.0,
)
_CAR = new(
    "world.Drive",
    kind="car",
    max_speed_mps=0.7,
    max_acceleration_mps2=1.0,
    wheelbase_m=0.3,
    max_steering_rad=0.5,
    max_steering_rate_radps=1.0,
)
_ROUND = new("world.Robot", radius_m=0.2, mass_kg=5.0, drive=_WHEELS, start=Pose(1.7, 0.0, 0.0))
_SQUARE = new(
    "world.Robot", radius_m=0.3, mass_kg=5.0, drive=_CAR, start=Pose(0.0, 0.0, 0.5), footprint_m=_box(-0.2, -0.2, 0.4)
)
_BOX = new(
    "world.MovableObject",
    radius_m=0.3,
    mass_kg=2.0,
    friction=0.4,
    start=Pose(0.0, 2.0, 0.0),
    corners_m=_box(-0.2, -0.2, 0.4),
)
_MANNERS = new(
    "world.CrowdParameters",
    time_gap_s=1.0,
    neighbour_strength=8.0,
    neighbour_range_m=0.1,
    wall_strength=5.0,
    wall_range_m=0.05,
    longest_substep_s=0.05,
)
_CROWD = new("world.Crowd", [_WALL], [_INSTANT, _DOOR], _MANNERS)
_WALKERS = np.array([[0.0, 0.0, 5.0, 0.0, 1.2, 0.15], [0.5, 0.1, 5.0, 1.0, 1.0, 0.15]])
_WORLD = new("world.World", [_WALL], [_INSTANT, _DOOR], [_ROUND, _SQUARE], 0.1, 2, [_BOX])
_TWISTS = np.array([[0.5, 0.0, 0.2], [0.7, 0.0, 0.1]])
_STATE = ("poses", "twists", "motions", "in_contact", "object_poses", "contact_angles", "present", "arrivals")


def _world() -> Iterator[Call]:
    state = tuple((name,) for name in (*_STATE, "doors_version"))
    door = new("world.World", [_WALL], [_DOOR], [_ROUND], 0.1, 2, []).of
    yield door(("set_door", 0, False), ("step", _TWISTS[:1]), ("step", _TWISTS[:1]), ("door_states",), *state)
    yield _WORLD.of(("set_door", 0, False), ("step", _TWISTS), ("step", _TWISTS), *state, ("reset",), *state)
    yield _CROWD.of(("step", _WALKERS, np.array([[3.0, 0.0, 0.2]]), [True, False], 0.1))
    yield _WORLD.of(("set_pose", 0, Pose(1.0, 1.0, 0.1)), ("step", _TWISTS), *state)
    yield _WORLD.of(("remove_robot", 1), ("spawn_robot", 1, Pose(0.5, -2.0, 1.0)), ("step", _TWISTS), *state)
    yield _WORLD.of(("add_object", _BOX), ("step", _TWISTS), ("remove_object", 0), ("object_poses",))
    speeds = np.array([[0.1, 0.0, 0.0, 0.0], [0.2, 0.1, 0.0, 0.3]])
    yield new("world.reached_speeds", [_WHEELS, _CAR], speeds, _TWISTS, 0.02)
    yield _WORLD.of(("set_object_pose", 0, Pose(0.5, 2.5, 0.1)), ("step", _TWISTS), ("object_poses",))


_FAN = new("world.Fan", beams=7, angle_min_rad=-1.5, angle_max_rad=1.5, forward_m=0.1, left_m=0.02, range_max_m=6.0)
_CASTER = new("world.FanCaster", _FAN, [_WALL], [_DOOR])
_LIMITS = new("sensing.RangeLimits", range_min_m=0.05, range_max_m=6.0, too_near_m=0.05, no_return_m=6.0)
_THREE = np.full((2, 3), 0.1)


def _sensors() -> Iterator[Call]:
    yield _CASTER.of(("cast", _WORLD, [0, 1]))
    measured_m = np.array([[0.01, 2.0, 9.0], [2.0, 2.0, 2.0]])  # too near, a return, and none
    yield new("sensing.report", _LIMITS, measured_m, np.full((2, 3), 0.01))
    carried = new("sensing.Lasers", _FAN, _LIMITS, [0, 1], _CASTER)
    sensors = new("sensing.TeamSensors", [carried], [(0.01, 0.01, 0.02, 0.01)] * 2, 0.1, [False, True])
    state = new("state.State", 2, 7)
    contact, ranges_m = np.array([True, False]), np.full((2, 7), 2.0)
    motion = (_THREE, _THREE, _THREE, contact, {0: [0.5]}, [ranges_m])
    yield sensors.of(
        ("add_noise", np.full((3, 6), 0.1)),
        ("set_range_noise", np.full((2, 7), 0.01)),
        ("read", state, _WORLD),
        ("set_haze", _HAZE),
        ("read_motion", state, *motion),
        ("restart", 0, np.full((1, 3), 0.1)),
        ("beams",),
        ("noise_left",),
    )
    ear = new("sensing.VoiceSensor", (-1.0, 2.0), 0.5, _MAP, 2.0)
    yield ear.of(("hear", state), ("hear", state))
    places = new("base.Places", [(0.0, 3.0)], [1.0])
    noisy = sensors.of(("add_noise", np.full((3, 6), 0.1)))
    team = (_WORLD, noisy, new("network.TeamLinks", _FACES, _RADIO, **_LINK_RULE), ear, places)
    batch = new("simulation.Batch", 2, 2, 7, 1)
    yield batch.of(("put", 1, *team), ("move", np.full((2, 2, 3), 0.1), [1]), ("sense", [1]))


def _states() -> Iterator[Call]:
    state = new("state.State", 2, 7)
    pose, place = PoseReading(0.5, 0.5, 0.0, 1.0), Pose(0.0, 3.0, 0.1)
    reading = RobotReading(pose, Twist(0.1), OdometryReading(pose, Twist()), np.ones(7, np.float32), True, (0.5,))
    numbers = ["true_pose", "positions_m", "true_twist", "contact", "odometry_pose", "odometry_twist"]
    numbers += ["odometry_pose_covariance", "odometry_twist_variances", "ranges_m", "happened", "voice_level_db"]
    numbers += ["voice_heard", "local_best_m", "local_best_level_db", "sensors", "__len__"]
    yield state.of(
        *(("place", robot_id, place) for robot_id in (0, 1)),
        *(("put_reading", robot_id, reading) for robot_id in (0, 1)),
        *(("put_voice", robot_id, VoiceReading(1.0, True, (0.0, 3.0), 2.0)) for robot_id in (0, 1)),
        *((name,) for name in numbers),
        ("readings",),
        ("voices",),
        ("voice_of", 1),
        ("ranges_of", 1),
    )
    totals = new("simulation.TeamTotals", 2, 2.0)
    yield totals.of(("add_step", state, [False, True], True), ("totals",))


def _learning() -> Iterator[Call]:
    limits = {"range_max_m": [6.0, 6.0], "max_speed_mps": [0.7, 0.5], "max_turn_radps": [2.0, 1.0]}
    plan = {"low_m": (-1.0, -1.0), "extent_m": (10.0, 8.0), "diagonal_m": 12.8, "voice_radius_m": 2.5}
    ranges_m, poses = np.full((1, 2, 7), 2.0, np.float32), np.array([[[0.5, 1.5, 0.0, 1.0], [3.0, 1.5, 0.6, 0.8]]])
    heard = np.array([[[[1.0, 2.0, 3.0, 0.1, 0.5]], [[0.0, 0.0, 0.0, 0.0, 0.0]]]])
    of_robots = ranges_m, poses, np.full((1, 2, 3), 0.1), np.full((1, 2, 4), 1.0)
    percepts = *of_robots, np.array([[[1.0, 2.0, 3.0]]]), heard, np.zeros((1, 2, 0))
    yield new("learning.vectors", new("learning.Units", **limits, **plan), _FACES, _RADIO, 1, *percepts)


def _recording() -> Iterator[Call]:
    sent = {"x": 1.0, "near": [1.0, 2.0], "matrix": [1.0, 2.0, 3.0], "stamp": 5, "count": 7, "is_on": 1, "name": "a"}
    types = {"x": "float64", "near": "float32", "matrix": "float64", "stamp": "time", "count": "uint16"}
    lengths = {"near": 0, "matrix": 3}
    attributes = (types | {"is_on": "bool", "name": "string"}).items()
    for is_cdr in (False, True):
        yield new("recording.MessageType", "my/Type", is_cdr).of(
            *(("add", name, kind, lengths.get(name, -1)) for name, kind in attributes),
            ("encode", sent),
            ("encode", {}),
        )
    part = new("recording.MessageType", "my/Part", False)
    yield part.of(("add", "x", "float64", -1), ("decode", struct.pack("<d", 1.0)))


_BURNING = new(
    "hazards.BurningFloor",
    np.ones((8, 12), np.bool_),
    np.ones((8, 12), np.bool_),
    [(0, 41, True), (0, 53, True)],
    [(True, 1.2, 0.01, 3.0)],
    [(10, 75, 0.5, 1.0, 3.0)],
    [(5000.0, 60.0, 0.2, []), (5000.0, 60.0, 0.2, [(0.0, 0.0), (10.0, 90.0)])],
    np.repeat(np.int32([0, 1]), 48).reshape(8, 12),
    gap_m=1.0,
    cell_m=0.5,
    diffusivity_m2_s=0.2,
    height_m=2.6,
    ambient_c=20.0,
    heat_kj_m3_k=1.2,
    convection_kw_m2_k=0.01,
    emissivity=0.8,
    soot_g_kj=0.003,
    convective_share=0.7,
)
_HAZE = new("hazards.Haze", (-1.0, 2.0), 0.5, _MAP, 8.7, 1.5)


def _hazards() -> Iterator[Call]:
    state = (("states",), ("soot_g_m2",), ("soot_g_m3", 2.6), ("temperature_c", 20.0, 820.0))
    numbers = (("heat_release_kw",), ("is_burnt_through", 0))
    burn = (("ignite", 40), ("advance", 1.0), ("set_door", 0, False), ("advance", 5.0))
    yield _BURNING.of(*burn, *state, *numbers)
    yield new("hazards.values_at", _MAP, (-1.0, 2.0), 0.5, np.array([[0.0, 3.0], [9.0, 9.0]]), 1.0)
    yield new("hazards.hot_in_sight", _MAP, (-1.0, 2.0), 0.5, 2.0, _GRID, _FROM, 4.0)
    yield new("sensing.dim", _FAN, np.array([[0.0, 3.0, 0.1], [1.0, 4.0, 0.2]]), _HAZE, 6.0, Output((2, 7), before=5.0))


def calls() -> tuple[Call, ...]:
    """Return the valid calls of all submodules."""
    return (
        *_plan(),
        *_control(),
        *_search(),
        *_signals(),
        *_world(),
        *_sensors(),
        *map_calls(),
        *_states(),
        *_learning(),
        *_recording(),
        *_hazards(),
    )
