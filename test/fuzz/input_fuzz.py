"""Any YAML text, scenario, bag and ROS message: it is read, or refused in one line, within 5 s and 1 GB.

Usage: python test/fuzz/input_fuzz.py [--seconds 60] [--seed 0] [yaml scenario bag message mission ...]; each target
gets the time. Inputs are valid ones with bytes changed, cut and put together at random; missions are drawn from the
schema, and run. An input that fails is printed and written to `failed-<target>`.
"""

from __future__ import annotations

import argparse
import contextlib
import faulthandler
import json
import random
import tempfile
import time
from collections.abc import Callable
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import Any

from peak_memory import peak_memory_mb
from random_missions import MissionMaker

from robotteamsim.errors import RobotTeamSimError
from robotteamsim.recording.topics import base, decisions, mission, radio, robots, world
from robotteamsim.scenario import from_mapping, load
from robotteamsim.scenario.shipped import shipped_scenario
from robotteamsim.scenario.yaml_text import parse
from robotteamsim.simulation import Observer, Simulation, StepRecord

TIME_LIMIT_S = 5.0
MISSION_TIME_LIMIT_S = 120.0
MEMORY_LIMIT_MB = 1024

WORDS = (
    *("a: 1\n", "- ", "[", "]", "{", "}", ", ", ": ", "? ", "\n", "\n  ", "  ", "&a ", "*a", "&b ", "*b", "<<: ", "<<"),
    *(
        "!!int ",
        "!!timestamp ",
        "!!python/name:os.system ",
        "!x ",
        "|\n",
        ">\n",
        "'",
        '"',
        "%YAML 9.9\n",
        "---\n",
        "...",
    ),
    *("0x", "1_", "1e999", ".nan", "-.inf", "0b", "~", "=", "@", "`", "\t", "\x00", "\x1b", "\ufeff", "\u2028", "é"),
    *(
        "name: x\n",
        "plan: garage\n",
        "robots: ",
        "count: 2",
        "control: ",
        "[1, 2]",
        "{a: [*a, *a]}",
        "#",
        "yes",
        "null",
    ),
)
ODD_BYTES = (b"\x00", b"\xff", b"\xff\xff\xff\xff", b"\x7f\xf0", b"\x00\x00\xc0\x7f", b"\n", b"A" * 40)

Check = Callable[[bytes], object]


def changed(data: bytes, generator: random.Random) -> bytes:
    """Return the bytes with some stretches changed, doubled or missing."""
    for _ in range(generator.randint(1, 4)):
        start, length = generator.randrange(len(data) + 1), generator.choice((0, 1, 1, 2, 4, 8, 64))
        new = generator.choice((*ODD_BYTES, generator.randbytes(length), data[start : start + 2 * length], b""))
        data = data[:start] + new + data[start + length :]
    return data[: generator.randrange(len(data) + 1)] if generator.random() < 0.1 else data


def _refused_in_one_line(read: Check, data: bytes) -> None:
    line = "read"
    try:
        read(data)
    except RobotTeamSimError as error:
        line = str(error)
    assert line.strip(), "an error without a message"
    assert "\n" not in line, f"an error of several lines: {line!r}"


class YamlTarget:
    """Any text."""

    def make(self, generator: random.Random) -> bytes:
        words = generator.choices(WORDS, k=generator.randint(1, 60))
        return "".join(words).encode()

    def check(self, data: bytes) -> None:
        _refused_in_one_line(lambda text: parse(text.decode("utf-8", "replace"), "x.yaml"), data)


class ScenarioTarget:
    """A shipped scenario with changes."""

    def __init__(self, folder: Path) -> None:
        self._path = folder / "odd.yaml"
        self._valid = shipped_scenario("tutorial_arena").read_bytes()

    def make(self, generator: random.Random) -> bytes:
        return changed(self._valid, generator)

    def check(self, data: bytes) -> None:
        self._path.write_bytes(data)
        _refused_in_one_line(lambda _: load(self._path), data)


class BagTarget:
    """A bag of a short mission with changes."""

    def __init__(self, folder: Path) -> None:
        from robotteamsim.recording import BagWriter
        from robotteamsim.simulation import Simulation

        self._path = folder / "odd.bag"
        scenario = load("tutorial_arena", ["mission.time_limit_s=0.3", "robots.count=1"])
        Simulation(scenario).run([BagWriter(self._path)])
        self._valid = self._path.read_bytes()

    def make(self, generator: random.Random) -> bytes:
        return changed(self._valid, generator)

    def check(self, data: bytes) -> None:
        self._path.write_bytes(data)
        _refused_in_one_line(self._read, data)

    def _read(self, _: bytes) -> None:
        from robotteamsim.recording.replay.reading import read_run

        read_run([self._path])


class MessageTarget:
    """A message of each topic that nodes subscribe to, with changes; needs ROS."""

    def __init__(self, _: Path) -> None:
        from geometry_msgs.msg import TwistStamped
        from nav_msgs.msg import Odometry
        from sensor_msgs.msg import LaserScan, NavSatFix, Range

        from robotteamsim import msg
        from robotteamsim.recording.bag_types import message_type
        from robotteamsim.scenario.sensors import Gps, HeatSensor, Sonar

        self._type_of = message_type
        self._targets = (
            (Odometry(), robots.read_odometry),
            (LaserScan(ranges=[1.0] * 20), partial(robots.read_ranges_m, beams=20)),
            (TwistStamped(), lambda message: base.read_twist(message.twist)),
            (Range(), Sonar(name="s").reading),
            (NavSatFix(), Gps(datum_lat_deg=0.0, datum_lon_deg=0.0).reading),
            (msg.Voice(), radio.read_voice),
            (msg.Contact(angles_rad=[1.0]), robots.read_contact),
            (msg.Heat(), HeatSensor().reading),
            (msg.Robots(present=bytes([1, 1]), arrivals=[1, 1]), partial(world.read_robots, num_robots=2)),
            (msg.ControllerStatus(has_goal=True, fault="x"), decisions.read_decision),
            (
                msg.NetworkMessages(messages=[msg.NetworkMessage(payload="{}")]),
                partial(radio.read_outbox, robot_id=0, num_robots=2),
            ),
            (
                msg.MissionStatus(
                    explored=bytes(3), victims=["saved"], undelivered=[msg.Discovery(name="a")], has_area=True
                ),
                partial(mission.read_task, num_robots=2),
            ),
            *_published(),
        )
        self._valid = [self._bytes(message) for message, _ in self._targets]

    @staticmethod
    def _bytes(message: Any) -> bytes:
        buffer = BytesIO()
        message.serialize(buffer)
        return buffer.getvalue()

    def make(self, generator: random.Random) -> bytes:
        index = generator.randrange(len(self._valid))
        return bytes([index]) + changed(self._valid[index], generator)

    def check(self, data: bytes) -> None:
        message, decode = self._targets[data[0] % len(self._targets)]
        with contextlib.suppress(ValueError):
            decode(self._type_of(message._type).decode(data[1:]))


def _published() -> tuple[tuple[Any, Callable[[Any], Any]], ...]:
    """Return messages of what a simulation publishes for everybody, and their readers."""
    from nav_msgs.msg import MapMetaData, OccupancyGrid

    from robotteamsim import msg

    return (
        (msg.MissionStatus(explored=bytes(3), victims=["saved"]), mission.read_status),
        (msg.MissionEvent(detail="x"), mission.read_event),
        (msg.Victims(victims=[msg.Victim(name="a")]), mission.read_victims),
        (msg.Areas(areas=[msg.Area(name="a", radius_m=1.0)]), mission.read_areas),
        (msg.Egress(people=[msg.PersonEgress(name="a")], exits=[msg.ExitEgress(name="b")]), mission.read_egress),
        (msg.Doors(doors=[msg.Door(name="a", opening=0.5)]), world.read_doors),
        (msg.People(people=[msg.Person(name="a", motion="walks")]), world.read_people),
        (msg.FloatMap(width=2, height=1, resolution_m=0.5, data=[1.0, 2.0]), base.read_field_map),
        (
            OccupancyGrid(info=MapMetaData(width=2, height=1, resolution=0.5), data=[0, 100]),
            base.read_occupancy_grid,
        ),
        (
            msg.NetworkLinks(num_robots=2, present=bytes([1, 1]), adjacency=bytes(2), endangered=bytes(2)),
            radio.read_network_links,
        ),
        (
            msg.NetworkState(num_robots=1, adjacency=bytes(1), endangered=bytes(1), hop_count=[0], rssi_dbm=[-50.0]),
            radio.read_network_state,
        ),
    )


class MissionTarget:
    """A mission drawn from the schema, which the loader accepts: it runs twice to the same bits, without a fault."""

    time_limit_s = MISSION_TIME_LIMIT_S

    def make(self, generator: random.Random) -> bytes:
        return json.dumps(MissionMaker(generator).mission()).encode()

    def check(self, data: bytes) -> None:
        _refused_in_one_line(self._run_twice, data)

    def _run_twice(self, data: bytes) -> None:
        scenario = from_mapping(json.loads(data), "random")
        first, second = (Simulation(scenario).run([NoFaults()]) for _ in range(2))
        assert first.trajectory_hash == second.trajectory_hash


class NoFaults(Observer):
    """No controller raises, or decides what it must not."""

    def step(self, record: StepRecord) -> None:
        faults = [decision.fault for decision in record.decisions if decision.fault]
        assert not faults, faults


TARGETS: dict[str, Callable[[Path], Any]] = {
    "yaml": lambda _: YamlTarget(),
    "scenario": ScenarioTarget,
    "bag": BagTarget,
    "message": MessageTarget,
    "mission": lambda _: MissionTarget(),
}


def fuzz(name: str, folder: Path, seconds: float, seed: int) -> int:
    """Check inputs of a target for a time; return their number."""
    target, generator, end_s, count = TARGETS[name](folder), random.Random(seed), time.monotonic() + seconds, 0
    while time.monotonic() < end_s:
        data = target.make(generator)
        faulthandler.dump_traceback_later(getattr(target, "time_limit_s", TIME_LIMIT_S), exit=True)
        try:
            target.check(data)
        except BaseException:
            Path(f"failed-{name}").write_bytes(data)
            print(f"{name}: seed {seed}, input {count}: {data!r:.2000}")
            raise
        finally:
            faulthandler.cancel_dump_traceback_later()
        count += 1
    return count


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("targets", nargs="*", metavar="TARGET", help=", ".join(TARGETS))
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    for name in options.targets or TARGETS:
        with tempfile.TemporaryDirectory() as folder:
            count = fuzz(name, Path(folder), options.seconds, options.seed)
        memory_mb = peak_memory_mb()
        assert memory_mb < MEMORY_LIMIT_MB, f"{name}: {memory_mb} MB"
        print(f"input_fuzz: {name}: {count} inputs, seed {options.seed}, {memory_mb} MB: nothing found", flush=True)


if __name__ == "__main__":
    main()
