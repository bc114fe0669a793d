from __future__ import annotations

import hashlib
import struct

from robotteamsim.geometry import PoseReading
from robotteamsim.rng import stream
from robotteamsim.simulation import TrajectoryHash

POSE = PoseReading(1.5, -2.25, 0.6, 0.8)


def test_hash_is_sha256_of_stamp_and_little_endian_poses():
    ours = TrajectoryHash()
    ours.update(100_000_000, [POSE, POSE])
    expected = struct.pack("<q4d4d", 100_000_000, 1.5, -2.25, 0.6, 0.8, 1.5, -2.25, 0.6, 0.8)
    assert ours.hexdigest() == hashlib.sha256(expected).hexdigest()


def test_one_bit_of_one_pose_changes_the_hash():
    one, other = TrajectoryHash(), TrajectoryHash()
    one.update(0, [POSE])
    other.update(0, [PoseReading(1.5000000000000002, -2.25, 0.6, 0.8)])
    assert one.hexdigest() != other.hexdigest()


def test_hash_can_be_read_during_the_run():
    ours = TrajectoryHash()
    ours.update(0, [POSE])
    assert ours.hexdigest() == ours.hexdigest()


def test_poses_as_an_array_and_as_records_have_the_same_hash():
    records, array = TrajectoryHash(), TrajectoryHash()
    rows = stream(1, "poses").normal(size=(3, 4))
    records.update(7, [PoseReading(*row) for row in rows.tolist()])
    array.update(7, rows)
    assert records.hexdigest() == array.hexdigest()
