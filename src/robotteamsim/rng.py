"""Named random streams: one seed, one independent generator per purpose."""

import hashlib

import numpy as np


def stream(seed: int, *name: str | int) -> np.random.Generator:
    """Return the generator of the stream `name`, such as ("odometry", robot_id).

    A stream depends only on the seed and its own name, so a new consumer of random numbers never shifts the numbers of
    another. The SHA-256 of the name enters the seed sequence; the generator is PCG64.

    Raises: ValueError: the seed is negative, or not a whole number.
    """
    if not isinstance(seed, int | np.integer) or seed < 0:
        raise ValueError(f"seed must be a whole number >= 0, got {seed!r:.60}")
    parts = (int(part) if isinstance(part, np.integer) else part for part in name)
    digest = hashlib.sha256("\x1f".join(map(repr, parts)).encode()).digest()
    words = np.frombuffer(digest, dtype="<u4").tolist()
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, *words])))
