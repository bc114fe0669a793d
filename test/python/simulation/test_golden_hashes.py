"""Trajectories keep their bits from one version to the next, in new processes, whatever the number of processors.

The C library rounds sine, logarithm and the like in one way on processors with fused multiply-add and in another on
those without, so each hash is kept for both. A change that means to move robots otherwise writes new ones and says why.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import subprocess
import sys

import pytest

from robotteamsim.geometry import Twist
from robotteamsim.scenario import load
from robotteamsim.simulation import Simulation

pytestmark = pytest.mark.slow

WITHOUT_FMA = "glibc.cpu.hwcaps=-AVX2_Usable,-FMA_Usable,-FMA4_Usable,-AVX2,-FMA,-FMA4,-AVX512F"
"""Lets the C library go by the older instructions."""

PROBE = (
    "import hashlib, math, struct;"
    "x = [1e-3 + 0.0037 * i for i in range(20000)];"
    "y = [f(v) for v in x for f in (math.sin, math.cos, math.log10, math.atan)];"
    "print(hashlib.sha256(struct.pack(f'<{len(y)}d', *y)).hexdigest()[:12])"
)
"""Prints what tells one C library's rounding from another's."""

CROWD = """
import hashlib, numpy as np
from robotteamsim.scenario import load
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.setup import resolve
from robotteamsim.world import World
loaded = load("garage_sar", ["robots.count=24", "robots.spacing_m=0.45"])
robots = resolve(loaded).robots
world = World(loaded.plan, robots, loaded.run)
sensors = RobotSensors(world, robots, 5)
generator, digest, touched = np.random.default_rng(5), hashlib.sha256(), np.zeros(24, bool)
for step in range(300):
    if step % 10 == 0:
        twists = generator.uniform((-0.7, 0.0, -2.0), (0.7, 0.0, 2.0), (24, 3))
    world.step(twists)
    state = sensors.read()
    touched |= state.contact
    for part in (state.true_pose, np.hstack((state.odometry_pose, state.odometry_twist)), state.ranges_m):
        digest.update(part.tobytes())
assert touched.sum() > 12, "the crowd must push and shove"
print(digest.hexdigest())
"""

GOLDEN = {
    "61ff4a26c1f2": {
        "garage_sar": "00261494eca73b2104c526119f77c129d9f3e5097c02a5e771f861901685d221",
        "tutorial_arena": "ab1a8fc655ab9c2f1ac593b3a922e6525ba45629091d1f949ddb44f5e537e85e",
        "crowd": "496781a347472c3b65f3c17ac0621f966adca46d5539c021de7e0b44c9dd0680",
    },
    "5aa001dd2fd4": {
        "garage_sar": "9c0ae70f41d1887affb33ab4821fc54790a5648cd05758f66ed373abf5122fcf",
        "tutorial_arena": "1becd6c3d4543bbca5039fa9efc969a295745a71b4ea8bd302b438c0e73e3b67",
        "crowd": "529c6fa3846c5399dad3a0218008d30bbb5a5ddc78b581c2e75b8b99f003f266",
    },
}
"""By what the probe prints."""


def output(*command: str, without_fma: bool = False, **environment: str) -> str:
    """Return what a new Python process prints."""
    if without_fma:
        environment["GLIBC_TUNABLES"] = WITHOUT_FMA
    ran = subprocess.run(
        [sys.executable, *command],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | environment,
        timeout=120,
    )
    return ran.stdout.strip()


def expected(what: str, without_fma: bool) -> str:
    probe = output("-c", PROBE, without_fma=without_fma)
    if probe not in GOLDEN:
        pytest.skip(f"no hashes are kept for a C library that rounds as this one does ({probe})")
    return GOLDEN[probe][what]


def mission_hash(name: str, **how) -> str:
    command = ("-m", "robotteamsim.cli", "run", name, "--json", "--set", "mission.time_limit_s=60")
    return json.loads(output(*command, **how))["trajectory_hash"]


@pytest.mark.parametrize("without_fma", [False, True], ids=["this processor", "without FMA"])
@pytest.mark.parametrize("name", ["garage_sar", "tutorial_arena"])
def test_missions_have_the_hashes_of_record(name, without_fma):
    assert mission_hash(name, without_fma=without_fma) == expected(name, without_fma)


@pytest.mark.parametrize("without_fma", [False, True], ids=["this processor", "without FMA"])
def test_crowd_that_collides_has_the_hash_of_record(without_fma):
    assert output("-c", CROWD, without_fma=without_fma) == expected("crowd", without_fma)


def test_hash_does_not_depend_on_the_number_of_processors_or_the_order_of_sets():
    several = {"OMP_NUM_THREADS": "3", "OPENBLAS_NUM_THREADS": "3"}
    one = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    here = mission_hash("garage_sar", PYTHONHASHSEED="1", **several)
    allowed = os.sched_getaffinity(0)
    try:
        os.sched_setaffinity(0, {min(allowed)})
        assert mission_hash("garage_sar", PYTHONHASHSEED="2", **one) == here
    finally:
        os.sched_setaffinity(0, allowed)


def test_world_and_sensors_begin_the_same_again_after_a_reset():
    simulation = Simulation(load("tutorial_arena", ["mission.time_limit_s=60"]))

    def driven() -> str:
        digest = hashlib.sha256()
        for step in range(200):
            simulation.world.step([Twist(0.6, 0.0, math.sin(0.1 * step))] * simulation.world.num_robots)
            state = simulation.sensors.read()
            for part in (state.true_pose, state.odometry_pose, state.odometry_twist, state.ranges_m):
                digest.update(part.tobytes())
        return digest.hexdigest()

    first = driven()
    simulation.world.reset()
    simulation.sensors.reset()
    assert driven() == first
