from __future__ import annotations

import hashlib
import struct

import numpy as np

from robotteamsim.simulation import TrajectoryHash

POSE = (1.5, -2.25, 0.6, 0.8)


def test_hash_is_sha256_of_stamp_and_little_endian_poses():
    ours = TrajectoryHash()
    ours.update(100_000_000, np.array([POSE, POSE]))
    expected = struct.pack("<q4d4d", 100_000_000, *POSE, *POSE)
    assert ours.hexdigest() == ours.hexdigest() == hashlib.sha256(expected).hexdigest()


def test_one_bit_of_one_pose_changes_the_hash():
    one, other = TrajectoryHash(), TrajectoryHash()
    one.update(0, np.array([POSE]))
    other.update(0, np.array([(1.5000000000000002, *POSE[1:])]))
    assert one.hexdigest() != other.hexdigest()
