"""How right the maps are of robots that do not know the building: python -m study.unknown.mapping

Teams cover a building with true poses; then each robot maps it from its odometry and its laser alone, with other noise
in each draw, on the same path. It leaves out the beams that end at a teammate, whose true place it knows here. Printed
per mission and laser, over all robots and draws: the share of occupied cells within 10 cm of a true wall, in the true
frame and after the best rigid alignment; the share of reachable free cells that are known; the errors of the poses at
updates, the computing time of an update, and the memory.
"""

from __future__ import annotations

import argparse
import math
import multiprocessing
import statistics
import time
from dataclasses import dataclass

import numpy as np
import scipy.ndimage
import shapely

from robotteamsim.geometry import Pose, normalise_angle
from robotteamsim.maps.own_map import mapper_of
from robotteamsim.scenario.controllers.mapping import Mapping
from robotteamsim.scenario.floor_plan import FloorPlan
from robotteamsim.scenario.plan import FREE, obstacles, occupancy_grid
from study.unknown.recording import beams_at_teammates, measured_again, record

NEAR_M = 0.1
"""An occupied cell this near a true wall is right."""

MARGIN_M = 0.15
"""Beams that end so near a teammate are left out."""

MISSIONS = {
    "garage": ("garage_sar", ["control.algorithm=cover"]),
    "garage_formation": ("garage_sar", []),
    "office": ("office_manet", ["control.c4=0", "robots.count=5"]),
}
LASERS = {
    "long": ["beams=361", "angle_min_rad=-3.141592653589793", "angle_max_rad=3.141592653589793", "range_max_m=12"],
    "default": [],
}


@dataclass(frozen=True)
class Outcome:
    """What one robot has mapped in one draw; see the module."""

    share: float
    aligned_share: float
    coverage: float
    median_m: float
    worst_m: float
    worst_rad: float
    lost_updates: int
    update_ms: float
    memory_mb: float
    submaps: int


class Truth:
    """The true walls of a building, and its free cells that a robot reaches."""

    def __init__(self, plan: FloorPlan, start_m: tuple[float, float]) -> None:
        self._walls = obstacles(plan)
        shapely.prepare(self._walls)
        grid = occupancy_grid(plan, NEAR_M)
        parts, _ = scipy.ndimage.label(grid.cells == FREE)
        column, row = (int((at - low) / NEAR_M) for at, low in zip(start_m, grid.origin_m, strict=True))
        rows, columns = np.nonzero(parts == parts[row, column])
        low_x_m, low_y_m = grid.origin_m
        self._free_m = np.stack([low_x_m + (columns + 0.5) * NEAR_M, low_y_m + (rows + 0.5) * NEAR_M], axis=1)

    def share(self, points_m: np.ndarray) -> float:
        """Return the share of points near a wall; NaN without points."""
        near = shapely.dwithin(self._walls, shapely.points(points_m), NEAR_M)
        return float(np.mean(near)) if len(points_m) else math.nan

    def aligned(self, points_m: np.ndarray, rounds: int = 10) -> np.ndarray:
        """Return points, moved as a whole to where they are nearest to the walls."""
        sample = points_m[:: max(1, len(points_m) // 1000)]
        outlines = shapely.boundary(self._walls)
        for _ in range(rounds):
            lines = shapely.shortest_line(shapely.points(sample), outlines)
            nearest = shapely.get_coordinates(lines).reshape(-1, 2, 2)[:, 1]
            close = np.linalg.norm(nearest - sample, axis=1) < 1.0
            centre, target = sample[close].mean(axis=0), nearest[close].mean(axis=0)
            u, _, v = np.linalg.svd((sample[close] - centre).T @ (nearest[close] - target))
            turn = v.T @ np.diag([1.0, np.linalg.det(v.T @ u.T)]) @ u.T
            sample, points_m = ((some - centre) @ turn.T + target for some in (sample, points_m))
        return points_m

    def coverage(self, origin_m: tuple[float, float], known: np.ndarray, cell_m: float) -> float:
        """Return the share of the reachable free cells that a map knows."""
        columns, rows = (np.floor((self._free_m - origin_m) / cell_m).astype(int)).T
        inside = (rows >= 0) & (rows < known.shape[0]) & (columns >= 0) & (columns < known.shape[1])
        return float(np.sum(known[rows[inside], columns[inside]]) / len(self._free_m))


def mapped(mission: tuple[str, ...], robot_id: int, seed: int, noise_m: float) -> Outcome:
    """Let a robot map a building on its path in a mission, name and keys, with the noise of a seed."""
    recording = record(*mission)
    robot, tuning = recording.setup.robots[robot_id], Mapping()
    mapper = mapper_of(robot.laser, tuning, Pose(*map(float, recording.poses[0, robot_id])))
    errors_m, errors_rad, lost_updates, cpu_s = [], [], 0, 0.0
    for step, measured in enumerate(measured_again(recording, robot_id, seed, noise_m), start=1):
        masked = beams_at_teammates(recording, robot_id, step, MARGIN_M)
        began_s = time.process_time()
        is_update = mapper.step(measured.odometry, measured.covariance, measured.ranges_m, masked)
        cpu_s += time.process_time() - began_s
        if is_update:
            x_m, y_m, yaw_rad = recording.poses[step, robot_id]
            errors_m.append(math.hypot(mapper.pose.x_m - x_m, mapper.pose.y_m - y_m))
            errors_rad.append(abs(normalise_angle(mapper.pose.yaw_rad - yaw_rad)))
            lost_updates += mapper.is_lost
    origin_m, cells = mapper.take_changes(1)
    rows, columns = np.nonzero(cells == 100)
    occupied_m = np.array(origin_m) + (np.stack([columns, rows], axis=1) + 0.5) * tuning.cell_m
    truth = Truth(recording.setup.plan, recording.setup.start_m(robot_id))
    return Outcome(
        share=truth.share(occupied_m),
        aligned_share=truth.share(truth.aligned(occupied_m)),
        coverage=truth.coverage(origin_m, cells >= 0, tuning.cell_m),
        median_m=statistics.median(errors_m),
        worst_m=max(errors_m),
        worst_rad=max(errors_rad),
        lost_updates=lost_updates,
        update_ms=1e3 * cpu_s / len(errors_m),
        memory_mb=mapper.bytes / 1e6,
        submaps=mapper.num_submaps,
    )


def _print_line(mission: str, laser: str, outcomes: list[Outcome]) -> None:
    shares = sorted(outcome.share for outcome in outcomes)
    aligned = sorted(outcome.aligned_share for outcome in outcomes)
    print(
        f"{mission:>17} {laser:>8} {len(outcomes):4d}"
        f" {shares[0]:6.3f} {statistics.median(shares):6.3f} {sum(share >= 0.95 for share in shares):4d}"
        f" {aligned[0]:7.3f} {statistics.fmean(outcome.coverage for outcome in outcomes):8.3f}"
        f" {statistics.median(outcome.median_m for outcome in outcomes):8.3f}"
        f" {max(outcome.worst_m for outcome in outcomes):7.3f}"
        f" {math.degrees(max(outcome.worst_rad for outcome in outcomes)):7.2f}"
        f" {sum(outcome.lost_updates > 0 for outcome in outcomes):4d}"
        f" {statistics.fmean(outcome.update_ms for outcome in outcomes):9.2f}"
        f" {max(outcome.memory_mb for outcome in outcomes):6.2f}",
        flush=True,
    )


def main() -> None:
    """Print a line per mission and laser."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--missions", nargs="+", choices=MISSIONS, default=["garage", "office"], help="%(default)s")
    parser.add_argument("--lasers", nargs="+", choices=LASERS, default=["long"], help="%(default)s")
    parser.add_argument("--draws", type=int, default=20, help="of the noise, per robot; default %(default)s")
    parser.add_argument("--noise", type=float, default=0.01, help="of a range, standard deviation [m]; %(default)s")
    parser.add_argument("--seed", type=int, default=7001, help="of the mission and the first draw; %(default)s")
    parser.add_argument("--jobs", type=int, default=multiprocessing.cpu_count(), help="processes; %(default)s")
    options = parser.parse_args()
    print(
        "          mission    laser maps  least median >=.95 aligned coverage  median   worst   worst lost"
        "    update memory\n"
        "                                      share                                 [m]     [m]   [deg]"
        "           [ms]   [MB]"
    )
    for mission in options.missions:
        name, overrides = MISSIONS[mission]
        for laser in options.lasers:
            keys = *overrides, *(f"robots.laser.{key}" for key in LASERS[laser]), f"run.seed={options.seed}"
            robot_ids = record(name, *keys).moving()
            tasks = [
                ((name, *keys), robot_id, options.seed + draw, options.noise)
                for draw in range(options.draws)
                for robot_id in robot_ids
            ]
            # Forked processes inherit the recording.
            with multiprocessing.get_context("fork").Pool(options.jobs) as pool:
                _print_line(mission, laser, pool.starmap(mapped, tasks, chunksize=1))


if __name__ == "__main__":
    main()
