from __future__ import annotations

import struct
import zlib

import numpy as np
import pytest

from robotteamsim.campaign import Trial, decode_paths, run_trial
from robotteamsim.campaign.paths import PERIOD_S, PathLog, encode_paths
from robotteamsim.errors import CampaignError
from robotteamsim.scenario import load
from robotteamsim.scenario.sections import Run
from robotteamsim.simulation import Simulation

VERSION = "0.1.0"


class Witness:
    """Keeps every true position."""

    def begin(self, scenario):
        self.positions_m = []

    def step(self, record):
        self.positions_m.append([(r.ground_truth.x_m, r.ground_truth.y_m) for r in record.readings])

    def end(self, result):
        pass

    def abandon(self):
        pass


def test_encoded_paths_come_back_to_a_centimetre():
    positions_m = np.random.Generator(np.random.PCG64(1)).normal(0.0, 1000.0, (50, 4, 2))
    data = encode_paths(positions_m)
    assert np.abs(decode_paths(data) - positions_m).max() <= 0.005 + 1e-9
    assert encode_paths(decode_paths(data)) == data


def test_encoded_paths_are_differences_in_centimetres():
    positions_m = np.array([[[1.0, 2.0]], [[1.5, 1.0]]])
    assert decode_paths(encode_paths(positions_m)).tolist() == positions_m.tolist()
    assert encode_paths(positions_m)[:8] == b"\x02\x00\x00\x00\x01\x00\x00\x00"


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\x01\x00",
        b"\x02\x00\x00\x00\x01\x00\x00\x00nonsense",
        struct.pack("<II", 0, 3) + zlib.compress(b""),
        struct.pack("<II", 2**32 - 1, 2**32 - 1) + zlib.compress(b""),
        struct.pack("<II", 2, 1) + zlib.compress(bytes(8)),
        struct.pack("<II", 1, 1) + zlib.compress(bytes(16)),
        struct.pack("<II", 1, 1) + zlib.compress(bytes(8))[:-4],
    ],
)
def test_bytes_that_do_not_encode_paths_are_rejected(data):
    with pytest.raises(CampaignError, match=r"^stored paths cannot be read: .+"):
        decode_paths(data)


@pytest.mark.parametrize("step_s", [0.1, 0.25])
def test_trial_keeps_where_its_robots_were_once_a_second(hall_scenario, step_s):
    scenario = hall_scenario(seed=5, run=Run(seed=5, step_s=step_s))
    witness = Witness()
    Simulation(scenario).run([witness])
    wanted_m = np.array(witness.positions_m)[:: round(PERIOD_S / step_s)]
    kept_m = decode_paths(run_trial(scenario, Trial(0, 1, 5), VERSION).paths)
    assert kept_m.shape == wanted_m.shape
    assert np.abs(kept_m - wanted_m).max() <= 0.005 + 1e-9


def test_robot_that_is_not_there_counts_as_where_it_was_noted_last():
    overrides = ["schedule=[{at_s: 1.5, remove: 1}]", "mission.time_limit_s=4"]
    log = PathLog()
    Simulation(load("garage_sar", overrides)).run([log])
    paths = decode_paths(log.encoded())
    assert np.array_equal(paths[2, 1], paths[1, 1])
    assert not np.array_equal(paths[1, 1], paths[0, 1])
