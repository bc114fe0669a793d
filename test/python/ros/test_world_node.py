from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import Range
from tf2_msgs.msg import TFMessage

from robotteamsim.geometry import Twist
from robotteamsim.ros.nodes import elsewhere, objects, team_outputs
from robotteamsim.ros.nodes import world as world_node
from robotteamsim.ros.nodes.gate import Gate, Pacer
from robotteamsim.ros.transport import msg_conversion as conversion
from robotteamsim.ros.transport.node import ParameterError
from robotteamsim.ros.transport.serialization import deserialized
from robotteamsim.ros.transport.settings import Settings
from robotteamsim.scenario.floor_plan import Door
from robotteamsim.scenario.scenario import Scenario
from robotteamsim.scenario.sections import PlacedRobot
from robotteamsim.scenario.sensors import Gps, MountedLaser, Sonar
from robotteamsim.sensing.readings import RobotReading
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world import World
from robotteamsim.world.doors import DoorState
from robotteamsim.world.placement import placed_robots

STEPS = 3
STEP_NS = 100_000_000


class FakeOutput:
    """Keeps what all topics publish, in order."""

    sent: list[tuple[str, Any]]

    def __init__(self, topic: str, message_class: type, *, latched: bool = False) -> None:
        self._topic = topic
        self._message_class = message_class
        self.wanted = True
        self.num_subscribers = 0

    def publish(self, message: Any) -> None:
        FakeOutput.sent.append((self._topic, message))


class FakeTeamTopic:
    """Keeps the arrays that the topics of all robots publish, in order, as (stamp [ns], arrays)."""

    def __init__(self, topics: list[str], examples: list[bytes], *, latched: bool) -> None:
        assert len(topics) == len(examples)
        self._topics = topics
        self.is_wanted = True
        self.num_subscribers = 0

    def publish(self, time_ns: int, *arrays: Any, present: Any = None) -> None:
        FakeOutput.sent += [(topic, (time_ns, arrays)) for topic in self._topics]


class FakeFrames:
    """Keeps when frames are published, and with which ones it began."""

    frames: list[TransformStamped]

    def __init__(self, topic: str, examples: list[bytes], origins: list[bytes]) -> None:
        messages = [deserialized(TFMessage, data) for data in (*examples, *origins)]
        FakeFrames.frames = [transform for message in messages for transform in message.transforms]
        self.is_wanted = True

    def publish(self, time_ns: int, *arrays: Any) -> None:
        FakeOutput.sent.append(("/tf", (time_ns, arrays)))


class FakeTeam:
    """Lets the world take some steps, straight ahead, and then ends it."""

    def __init__(self, *_: object, **__: object) -> None:
        self.restarted = False

    def assemble(self) -> None:
        pass

    def note_presence(self, stamp_ns: int, present: tuple[bool, ...]) -> None:
        assert present == (True, True)

    def twists(self, step_index: int, sim_time_ns: int) -> list[Twist] | None:
        return [Twist(0.5, 0.0, 0.0), Twist()] if step_index < STEPS else None


class FakeGate(Gate):
    """Lets a wall clock of its own run while it sleeps."""

    now_s = 0.0

    def sleep(self, duration_s: float) -> bool:
        FakeGate.now_s += duration_s
        return True


class ResumedGate(FakeGate):
    """Resumes a world that waits, and keeps which topics had been published by then."""

    topics: list[str]

    def wait(self) -> bool:
        if self._paused:
            ResumedGate.topics = [topic for topic, _ in FakeOutput.sent]
            self.resume()
        return super().wait()


@pytest.fixture
def serve(monkeypatch, hall_scenario) -> Callable[..., None]:
    """Let a world take its first steps at a speed: that of the hall, or another."""
    FakeOutput.sent = []
    FakeGate.now_s = 0.0
    parameters = {"~speed": 0.0, "~localization": "ground_truth", "~odometry": "step"}
    parameters |= {"~stage_requests": False, "~paused": False}
    monkeypatch.setattr(world_node, "Output", FakeOutput)
    monkeypatch.setattr(team_outputs, "Output", FakeOutput)
    monkeypatch.setattr(objects, "Output", FakeOutput)
    monkeypatch.setattr(world_node, "FreeTeam", FakeTeam)
    monkeypatch.setattr(world_node, "parameter", lambda name, default: parameters[name])
    monkeypatch.setattr(elsewhere, "parameter", lambda name, default: default)
    monkeypatch.setattr(elsewhere, "message_queue", lambda: None)
    monkeypatch.setattr(world_node, "QUIET_S", 0.0)
    monkeypatch.setattr(world_node, "Service", lambda *_: None)
    monkeypatch.setattr(world_node, "command", lambda *_, **__: None)
    for name in ("OdometryTopic", "ScanTopic", "ContactTopic"):
        monkeypatch.setattr(team_outputs.roscpp, name, FakeTeamTopic)
    monkeypatch.setattr(team_outputs.roscpp, "FramesTopic", FakeFrames)
    monkeypatch.setattr(world_node, "Gate", FakeGate)
    monkeypatch.setattr(world_node, "Pacer", lambda speed: Pacer(speed, lambda: FakeGate.now_s))

    def make(
        speed: float, scenario: Scenario | None = None, odometry: str = "step", controllers: bool = True, **more: bool
    ) -> None:
        parameters["~speed"], parameters["~odometry"] = speed, odometry
        parameters["~paused"] = more.get("paused", False)
        scenario = scenario or hall_scenario()
        lockstep = more.get("lockstep", False)
        settings = Settings(scenario, lockstep, controllers, teleop=-1, silence_limit_s=5.0)
        world_node.WorldNode(settings).serve()

    return make


@pytest.fixture
def sent(serve) -> list[tuple[str, Any]]:
    """What a world publishes in its first steps."""
    serve(0.0)
    return FakeOutput.sent


def test_clock_comes_after_all_else_of_its_step(sent):
    clock_ns = 0
    stamps: dict[str, list[int]] = {}
    for topic, message in sent:
        if topic == "/clock":
            clock_ns = message.clock.to_nsec()
        elif topic != "/map":
            stamp_ns = message[0] if isinstance(message, tuple) else conversion.stamp_ns(message)
            assert stamp_ns > clock_ns, topic
            stamps.setdefault(topic, []).append(stamp_ns)
    names = ["odom", "base_scan", "base_pose_ground_truth", "contact"]
    assert sorted(stamps) == sorted(
        [
            "/tf",
            "/world/robots",
            "/world/team_state",
            *(f"/robot_{robot_id}/{name}" for robot_id in (0, 1) for name in names),
        ]
    )
    assert set(map(tuple, stamps.values())) == {(STEP_NS, 2 * STEP_NS, 3 * STEP_NS)}


def test_clock_starts_near_zero_and_ticks_with_the_physics(sent):
    ticks_ns = [message.clock.to_nsec() for topic, message in sent if topic == "/clock"]
    # The last step is not taken, but the clock has already run up to it.
    assert ticks_ns == [1_000_000, *(20_000_000 * tick for tick in range(1, 5 * STEPS + 5))]


def _stamps_and_places(topic: str) -> dict[int, tuple[float, ...]]:
    """Return where robot 0 is in what was sent on a topic: x, y, z, w by stamp [ns]."""
    return {time_ns: tuple(arrays[0][0, :4]) for name, (time_ns, arrays) in _of(topic)}


def _of(topic: str) -> list[tuple[str, Any]]:
    return [(name, message) for name, message in FakeOutput.sent if name == topic]


@pytest.mark.parametrize("topic", ["/robot_0/odom", "/tf"])
def test_odometry_and_tf_come_with_each_tick_of_the_clock_on_demand(serve, topic):
    serve(0.0)
    at_steps, scans = _stamps_and_places(topic), len(_of("/robot_0/base_scan"))
    FakeOutput.sent.clear()
    serve(0.0, odometry="clock", controllers=False)
    places = _stamps_and_places(topic)
    assert list(places) == [STEP_NS, *range(STEP_NS + 20_000_000, STEPS * STEP_NS + 1, 20_000_000)]
    assert {time_ns: places[time_ns] for time_ns in at_steps} == at_steps
    ways_m = [places[STEP_NS + tick * 20_000_000][0] for tick in range(6)]
    assert ways_m == pytest.approx([ways_m[0] + (ways_m[-1] - ways_m[0]) * tick / 5 for tick in range(6)])
    assert len(_of("/robot_0/base_scan")) == scans
    # A client that sees a tick of the clock has the odometry of that tick, or gets it next.
    clock_ns = 0
    for name, message in FakeOutput.sent:
        if name == "/clock":
            assert clock_ns < STEP_NS or message.clock.to_nsec() in places
            clock_ns = message.clock.to_nsec()
        elif name == topic:
            assert message[0] > clock_ns


def test_world_that_starts_paused_makes_no_step_before_it_is_resumed(serve, monkeypatch):
    monkeypatch.setattr(world_node, "Gate", ResumedGate)
    serve(0.0, paused=True)
    assert ResumedGate.topics == ["/map", "/clock"]
    assert "/robot_0/odom" in {topic for topic, _ in FakeOutput.sent}


@pytest.mark.parametrize(
    ("keywords", "message"),
    [
        ({"odometry": "10"}, "~odometry: '10'; expected step or clock"),
        ({"odometry": "clock"}, "~odometry: clock does not work with controllers of this package, .*expected step"),
        ({"odometry": "clock", "lockstep": True}, "~odometry: clock does not work with lockstep; expected step"),
    ],
)
def test_wrong_rate_of_odometry_is_rejected(serve, keywords, message):
    with pytest.raises(ParameterError, match=f"^{message}$"):
        serve(0.0, **keywords)


@pytest.mark.parametrize(("speed", "wall_s"), [(0.0, 0.0), (5.0, 0.076), (0.5, 0.76), (0.01, 38.0)])
def test_world_lasts_as_long_as_its_speed_says(serve, speed, wall_s):
    serve(speed)
    # Time is counted from the first of the four steps' twenty ticks; the fourth step is not taken.
    assert FakeGate.now_s == pytest.approx(wall_s)


def test_true_motion_is_published(sent):
    truths = [message[1] for topic, message in sent if topic == "/robot_0/base_pose_ground_truth"]
    (first_poses, _), (last_poses, last_twists) = truths[0], truths[-1]
    assert first_poses[0, 0] < last_poses[0, 0] < 3.2
    assert last_twists[0, 0] > 0.0


def test_doors_are_published_at_every_step(serve, hall_scenario):
    scenario = hall_scenario()
    gate = Door(name="gate", start=(10.0, 0.2), end=(10.0, 1.2), motion="swing")
    serve(0.0, scenario.model_copy(update={"plan": scenario.plan.model_copy(update={"doors": (gate,)})}))
    told = [message for topic, message in FakeOutput.sent if topic == "/world/doors"]
    assert [conversion.stamp_ns(message) for message in told] == [STEP_NS, 2 * STEP_NS, 3 * STEP_NS]
    assert conversion.door_states(told[0]) == {"gate": DoorState(closed=False, opening=1.0, motion="still")}


def test_map_frame_is_tied_to_odometry_on_demand(sent):
    of_map = {link.child_frame_id for link in FakeFrames.frames if link.header.frame_id == "map"}
    assert of_map == {"robot_0/odom", "robot_1/odom"}
    _, (odometry, origins, _) = next(message for topic, message in sent if topic == "/tf")
    assert origins.shape == (2, 4)
    assert len(odometry) == 2


SENSORS = {
    "lasers": (MountedLaser(name="rear", yaw_rad=3.0, noise_m=0.01), MountedLaser(name="slow", every_steps=2)),
    "gps": Gps(datum_lat_deg=40.0, datum_lon_deg=-8.0, rate_hz=10.0),
    "sonars": (Sonar(name="left", yaw_rad=0.4, noise_m=0.01), Sonar(name="right", yaw_rad=-0.4)),
}


@pytest.fixture
def equipped(hall_scenario) -> Scenario:
    """The hall with a robot that carries all there is, and one that does not."""
    start = (18.8, 4.0, 0.1)
    return hall_scenario(robots=(PlacedRobot(start_pose=start, **SENSORS), PlacedRobot(start_pose=(3.0, 6.0, 0.0))))


def headless_readings(scenario: Scenario) -> list[RobotReading]:
    """Return what robot 0 reads when the same steps are taken without ROS."""
    robots = placed_robots(scenario)
    world = World(scenario.plan, robots, scenario.run)
    sensors = RobotSensors(world, robots, scenario.run.seed)
    record = []
    for _ in range(STEPS):
        world.step([Twist(0.5, 0.0, 0.0), Twist()])
        record.append(sensors.read()[0])
    return record


def test_further_lasers_have_topics_of_their_own_with_the_bits_of_a_headless_run(serve, equipped):
    serve(0.0, equipped)
    sent = FakeOutput.sent
    readings = headless_readings(equipped)
    rear = [message for topic, message in sent if topic == "/robot_0/rear"]
    assert [message.ranges for message in rear] == [reading.further.scans_m[0].tolist() for reading in readings]
    assert {message.header.frame_id for message in rear} == {"robot_0/rear_link"}
    slow = [message for topic, message in sent if topic == "/robot_0/slow"]
    assert [conversion.stamp_ns(message) for message in slow] == [2 * STEP_NS]
    assert not [topic for topic, _ in sent if topic.startswith("/robot_1/") and topic.endswith(("rear", "slow"))]


def test_sonars_have_topics_of_their_own_with_the_bits_of_a_headless_run(serve, equipped):
    serve(0.0, equipped)
    expected = [reading.further.sonars_m for reading in headless_readings(equipped)]
    for index, name in enumerate(("left", "right")):
        messages = [message for topic, message in FakeOutput.sent if topic == f"/robot_0/{name}"]
        assert [message.range for message in messages] == [ranges_m[index] for ranges_m in expected]
        assert {message.header.frame_id for message in messages} == {f"robot_0/{name}_link"}
        assert {message.radiation_type for message in messages} == {Range.ULTRASOUND}
    assert all(0.02 < ranges_m[0] < 3.0 for ranges_m in expected)


def test_fixes_have_the_bits_of_a_headless_run(serve, equipped):
    serve(0.0, equipped)
    messages = [message for topic, message in FakeOutput.sent if topic == "/robot_0/fix"]
    fixes = [reading.further.fix for reading in headless_readings(equipped)]
    assert len(messages) == STEPS
    assert [(m.latitude, m.longitude, m.altitude) for m in messages] == [
        (fix.latitude_deg, fix.longitude_deg, fix.altitude_m) for fix in fixes
    ]
    assert messages[0].position_covariance == [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0]


def test_further_sensors_have_frames_on_the_robot_that_carries_them(serve, equipped):
    serve(0.0, equipped)
    rear = [link for link in FakeFrames.frames if link.child_frame_id == "robot_0/rear_link"]
    assert len(rear) == 1
    assert {link.header.frame_id for link in rear} == {"robot_0/base_link"}
    rotation, place = rear[0].transform.rotation, rear[0].transform.translation
    assert 2.0 * math.atan2(rotation.z, rotation.w) == pytest.approx(3.0)
    assert (place.x, place.y, place.z) == (0.1, 0.0, 0.25)
    assert not [link for link in FakeFrames.frames if link.child_frame_id == "robot_1/rear_link"]
