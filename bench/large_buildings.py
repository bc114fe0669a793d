"""Floor plans of large buildings, as plain values: an office with corridors, and one with walls at any angle."""

from __future__ import annotations

import math

import numpy as np

ROOM_M = (4.0, 5.0)
"""Width along the corridor, and depth."""

CORRIDOR_M = 2.0
DOOR_M = 1.0
MOTIONS = ("instant", "swing", "slide")


def office(rooms: int, rooms_per_corridor: int = 40) -> dict:
    """Return a plan with rooms on both sides of corridors; every room has a door, and 3.5 walls.

    Corridors lie side by side. Their west ends meet in a hall, so that a robot reaches everything.

    Args: rooms: about how many; a corridor that is begun is finished.
    """
    width_m, depth_m = ROOM_M
    corridors = max(1, round(rooms / rooms_per_corridor))
    hall_m = 4.0
    east, pitch_m = hall_m + width_m * rooms_per_corridor / 2, 2.0 * depth_m + CORRIDOR_M
    north = corridors * pitch_m
    walls: list[dict] = []
    doors: list[dict] = []

    def wall(start: tuple[float, float], end: tuple[float, float], thickness_m: float) -> None:
        walls.append({"name": f"wall_{len(walls)}", "from": list(start), "to": list(end), "thickness_m": thickness_m})

    def door(start: tuple[float, float], end: tuple[float, float], inward: float) -> None:
        motion = MOTIONS[len(doors) % len(MOTIONS)]
        leaf = {"name": f"door_{len(doors)}", "from": list(start), "to": list(end), "closed": len(doors) % 4 == 0}
        if motion != "instant":
            leaf["motion"] = motion
        if motion == "swing":
            leaf["angle_rad"] = inward * math.pi / 2.0
        doors.append(leaf)

    for corridor in range(corridors):
        south = corridor * pitch_m
        for side, back in ((-1.0, south), (1.0, south + pitch_m)):
            front = south + pitch_m / 2.0 + side * CORRIDOR_M / 2.0
            for room in range(rooms_per_corridor // 2):
                west = hall_m + room * width_m
                gap = west + 1.5
                wall((west, front), (gap, front), 0.1)
                wall((gap + DOOR_M, front), (west + width_m, front), 0.1)
                wall((west, back), (west, front), 0.1 if room % 3 else 0.2)
                door((gap, front), (gap + DOOR_M, front), side)
                if side < 0.0 or corridor == corridors - 1:
                    wall((west, back), (west + width_m, back), 0.2)
        wall((east, south), (east, south + pitch_m), 0.3)
        wall((0.0, south), (0.0, south + pitch_m), 0.3)
    wall((0.0, 0.0), (hall_m, 0.0), 0.3)
    wall((0.0, north), (hall_m, north), 0.3)
    bounds = {"min": [0.0, 0.0], "max": [east, north]}
    return {"name": f"office_{rooms}", "bounds": bounds, "walls": walls, "doors": doors}


def slanted(count: int, seed: int = 1) -> dict:
    """Return a plan with walls of 1 to 6 m at any place and angle, one for each 8 m2, and free floor around them."""
    dice = np.random.default_rng(seed)
    side_m = math.sqrt(8.0 * count)
    middle = dice.uniform(10.0, 10.0 + side_m, (count, 2))
    angle_rad, length_m = dice.uniform(0.0, math.pi, count), dice.uniform(1.0, 6.0, count)
    half = 0.5 * length_m[:, None] * np.stack([np.cos(angle_rad), np.sin(angle_rad)], axis=1)
    ends = np.stack([middle - half, middle + half], axis=1).round(3).tolist()
    thickness_m = dice.choice([0.1, 0.2, 0.3], count).tolist()
    walls = [
        {"name": f"wall_{i}", "from": start, "to": end, "thickness_m": thick}
        for i, ((start, end), thick) in enumerate(zip(ends, thickness_m, strict=True))
    ]
    side = round(side_m + 20.0, 3)
    return {"name": f"slanted_{count}", "bounds": {"min": [0.0, 0.0], "max": [side, side]}, "walls": walls}
