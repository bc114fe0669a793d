"""Where amcl's likelihood field puts a robot that drives towards a wall: python -m study.amcl.offset

amcl is not in Debian, so these are its models with its default parameters: the likelihood field [thrun2005, Table
6.3] and the beam model [Table 6.1], each with amcl's sum of cubes; the odometry motion model, an update every 0.2 m,
and resampling at every second update. The scans are those of this package, or exact intersections by Shapely; the map
is solid, or has only the outlines of walls.
"""

from __future__ import annotations

import argparse
import itertools
import math
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
import scipy.ndimage
import shapely

from robotteamsim import palette
from robotteamsim.geometry import Pose, Twist
from robotteamsim.scenario import Bounds, FloorPlan, occupancy_grid
from robotteamsim.scenario.floor_plan import Block
from robotteamsim.scenario.plan import OCCUPIED, obstacles
from robotteamsim.scenario.sections import Laser, PlacedRobot, Run
from robotteamsim.sensing.robots import RobotSensors
from robotteamsim.world import World

RESOLUTION_M = 0.05
WALL_X_M = 14.0
LASER = Laser()
BEAMS = np.linspace(LASER.angle_min_rad, LASER.angle_max_rad, LASER.beams)
# The defaults of amcl_node.cpp: laser_z_hit, laser_z_short, laser_z_max, laser_z_rand, laser_lambda_short,
# laser_sigma_hit, laser_likelihood_max_dist, laser_max_beams, odom_alpha1 to 4 (all the same), update_min_d,
# resample_interval, initial_cov_xx and _aa.
Z_HIT, Z_SHORT, Z_MAX, Z_RAND, LAMBDA_SHORT = 0.95, 0.1, 0.05, 0.05, 0.1
SIGMA_HIT_M, FARTHEST_M, MAX_BEAMS = 0.2, 2.0, 30
ALPHA, UPDATE_MIN_M, RESAMPLE_INTERVAL = 0.2, 0.2, 2
START_SD = np.array([0.5, 0.5, math.pi / 12])
PARTICLES = 500
RAY_STEPS = 60
STEP_BEAMS = (LASER.beams - 1) // (MAX_BEAMS - 1)
MODELS = ("likelihood_field", "beam")
OFFSETS_M = np.linspace(-0.6, 0.8, 141)


@dataclass(frozen=True)
class Moment:
    """Truth, odometry, and the ranges of this package and of Shapely in one step."""

    truth: Pose
    odometry: Pose
    ranges_m: np.ndarray
    exact_m: np.ndarray


class SensorModel:
    """One of amcl's models of a laser, on a map."""

    def __init__(self, occupied: np.ndarray, name: str = "likelihood_field") -> None:
        """Args: name: of `laser_model_type`: likelihood_field or beam."""
        self._distances_m = RESOLUTION_M * scipy.ndimage.distance_transform_edt(~occupied)
        self._name = name

    def weights(self, poses: np.ndarray, ranges_m: np.ndarray) -> np.ndarray:
        """Return the weight of each pose of base_link, shape (n,), over all of amcl's beams."""
        chosen = slice(None, None, STEP_BEAMS)
        ranges_m, angles = ranges_m[chosen], poses[:, 2:] + BEAMS[chosen]
        x = poses[:, :1] + LASER.forward_m * np.cos(poses[:, 2:])
        y = poses[:, 1:2] + LASER.forward_m * np.sin(poses[:, 2:])
        returned = ranges_m < LASER.range_max_m
        if self._name == "beam":
            p = self._beam(x, y, angles, ranges_m) + np.where(returned, Z_RAND / LASER.range_max_m, Z_MAX)
        else:
            angles, ranges_m = angles[:, returned], ranges_m[returned]
            from_wall_m = self._distance_m(x + ranges_m * np.cos(angles), y + ranges_m * np.sin(angles))
            p = Z_HIT * _bell(np.minimum(from_wall_m, FARTHEST_M)) + Z_RAND / LASER.range_max_m
        weights: np.ndarray = 1.0 + np.sum(p**3, axis=1)
        return weights

    def _beam(self, x: np.ndarray, y: np.ndarray, angles: np.ndarray, ranges_m: np.ndarray) -> np.ndarray:
        """Return the probabilities of hits and of short readings. A ray goes on by its distance from all walls."""
        along_m, cosines, sines = np.zeros_like(angles), np.cos(angles), np.sin(angles)
        for _ in range(RAY_STEPS):
            free_m = self._distance_m(x + along_m * cosines, y + along_m * sines)
            along_m += np.where(free_m > 0.0, np.maximum(free_m - RESOLUTION_M, 0.4 * RESOLUTION_M), 0.0)
        error_m = ranges_m - np.minimum(along_m, LASER.range_max_m)
        short = Z_SHORT * LAMBDA_SHORT * np.exp(-LAMBDA_SHORT * ranges_m)
        return Z_HIT * _bell(error_m) + np.where(error_m < 0.0, short, 0.0)

    def _distance_m(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Return the distances of points from the nearest occupied cell; far outside the map."""
        # amcl rounds to the nearest cell's lower left corner, which shifts its map by half a cell.
        columns, rows = (np.floor(at / RESOLUTION_M + 0.5).astype(int) for at in (x, y))
        height, width = self._distances_m.shape
        inside = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
        distances_m = np.full(x.shape, FARTHEST_M)
        distances_m[inside] = self._distances_m[rows[inside], columns[inside]]
        return distances_m


def _bell(error_m: np.ndarray) -> np.ndarray:
    return np.exp(-(error_m**2) / (2.0 * SIGMA_HIT_M**2))


def hall(thickness_m: float, width_m: float) -> FloorPlan:
    """Return a hall of some width with walls of one thickness: one ahead, at x = 14 m, and one on each side."""
    far = WALL_X_M + thickness_m
    bottom, top = thickness_m, thickness_m + width_m
    boxes = (
        ("ahead", (WALL_X_M, 0.0), (far, top + thickness_m)),
        ("right", (0.0, 0.0), (WALL_X_M, bottom)),
        ("left", (0.0, top), (WALL_X_M, top + thickness_m)),
    )
    blocks = [Block(name=name, polygon=((x0, y0), (x1, y0), (x1, y1), (x0, y1))) for name, (x0, y0), (x1, y1) in boxes]
    return FloorPlan(name="hall", bounds=Bounds(max=(far + 1.0, top + thickness_m)), blocks=tuple(blocks))


def exact_ranges_m(solid: shapely.Geometry, base: Pose) -> np.ndarray:
    """Return ranges by Shapely, independent of this package's laser."""
    x = base.x_m + LASER.forward_m * math.cos(base.yaw_rad)
    y = base.y_m + LASER.forward_m * math.sin(base.yaw_rad)
    angles = base.yaw_rad + BEAMS
    ends = np.stack([x + LASER.range_max_m * np.cos(angles), y + LASER.range_max_m * np.sin(angles)], axis=1)
    rays = shapely.linestrings(np.stack([np.broadcast_to((x, y), ends.shape), ends], axis=1))
    distances_m = shapely.distance(shapely.intersection(solid, rays), shapely.Point(x, y))
    return np.asarray(np.fmin(distances_m, LASER.range_max_m))


def drive(plan: FloorPlan, speed_mps: float, seed: int) -> list[Moment]:
    """Drive straight on until the robot is 0.6 m from the wall; return every step."""
    centre_m = plan.bounds.max[1] / 2.0
    robot = PlacedRobot(start_pose=(3.0, centre_m, 0.0))
    world, solid = World(plan, [robot], Run()), obstacles(plan)
    sensors, moments = RobotSensors(world, [robot], seed), []
    while world.poses()[0].x_m < WALL_X_M - 0.6:
        world.step([Twist(speed_mps, 0.0, 0.0)])
        reading, truth = sensors.read()[0], world.poses()[0]
        odometry = reading.odometry.pose.pose
        moments.append(Moment(truth, odometry, np.array(reading.ranges_m), exact_ranges_m(solid, truth)))
    return moments


class ParticleFilter:
    """amcl with a fixed number of particles; their mean is the estimate."""

    def __init__(self, model: SensorModel, start: Pose, seed: int) -> None:
        self._model, self._random = model, np.random.default_rng(seed)
        self._poses = np.array([start.x_m, start.y_m, start.yaw_rad]) + START_SD * self._random.normal(
            size=(PARTICLES, 3)
        )
        self._weights = np.full(PARTICLES, 1.0 / PARTICLES)
        self._updates = 0

    def update(self, motion: Pose, ranges_m: np.ndarray) -> None:
        """Move the particles by the odometry, weigh them by a scan, and resample at every second update."""
        distance_m, turn_rad = math.hypot(motion.x_m, motion.y_m), motion.yaw_rad
        first = math.atan2(motion.y_m, motion.x_m)
        second = turn_rad - first
        noise = self._random.normal(size=(3, PARTICLES))
        first = first + noise[0] * math.sqrt(ALPHA * (first**2 + distance_m**2))
        along = distance_m + noise[1] * math.sqrt(ALPHA * (distance_m**2 + first.mean() ** 2 + second**2))
        second = second + noise[2] * math.sqrt(ALPHA * (second**2 + distance_m**2))
        self._poses[:, 0] += along * np.cos(self._poses[:, 2] + first)
        self._poses[:, 1] += along * np.sin(self._poses[:, 2] + first)
        self._poses[:, 2] += first + second
        self._weights *= self._model.weights(self._poses, ranges_m)
        self._weights /= self._weights.sum()
        self._updates += 1
        if self._updates % RESAMPLE_INTERVAL == 0:
            self._poses = self._poses[self._random.choice(PARTICLES, PARTICLES, p=self._weights)]
            self._weights[:] = 1.0 / PARTICLES

    @property
    def ahead_m(self) -> float:
        """x of the estimate."""
        return float(self._weights @ self._poses[:, 0])


def final_offset_m(model: SensorModel, moments: list[Moment], seed: int, exact: bool) -> float:
    """Return how far ahead of the truth the estimate is at the end of the drive [m]."""
    last = moments[0]
    localiser = ParticleFilter(model, last.truth, seed)
    for moment in moments[1:]:
        motion = last.odometry.inverse() @ moment.odometry
        if math.hypot(motion.x_m, motion.y_m) >= UPDATE_MIN_M:
            localiser.update(motion, moment.exact_m if exact else moment.ranges_m)
            last = moment
    return localiser.ahead_m - last.truth.x_m


def maps_of(plan: FloorPlan) -> dict[str, np.ndarray]:
    """Return which cells are occupied: in /map, whose walls are solid, and with only the outlines of walls."""
    solid = occupancy_grid(plan, RESOLUTION_M).cells == OCCUPIED
    outline = solid & ~scipy.ndimage.binary_erosion(solid, border_value=1)
    return {"solid": solid, "outline": outline}


def scores(model: SensorModel, moment: Moment) -> np.ndarray:
    """Return the weights of poses that are moved along the heading by `OFFSETS_M`."""
    truth = moment.truth
    poses = np.stack(
        [truth.x_m + OFFSETS_M, np.full_like(OFFSETS_M, truth.y_m), np.full_like(OFFSETS_M, truth.yaw_rad)], axis=1
    )
    return model.weights(poses, moment.ranges_m)


def check_scans(moments: list[Moment], speed_mps: float) -> None:
    """Print how far the ranges are from Shapely's, and from those of the poses one step earlier and later."""
    error_m = max(float(np.abs(m.ranges_m - m.exact_m).max()) for m in moments)
    ahead = LASER.beams // 2
    shifts_m = [
        float(np.mean([moments[i].ranges_m[ahead] - moments[i + shift].exact_m[ahead] for i in range(-30, -1)]))
        for shift in (-1, 0, 1)
    ]
    print(f"{len(moments)} scans at {speed_mps:g} m/s: largest difference from Shapely {error_m:.1e} m;")
    print(
        "of the beam ahead, from the pose a step earlier, of its stamp, and a step later: "
        + ", ".join(f"{s:+.4f}" for s in shifts_m)
    )


def main() -> None:
    """Print the checks and the offsets; draw the scores."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=10, help="runs of the filter (%(default)s)")
    parser.add_argument("--width", type=float, default=3.0, help="of the hall [m] (%(default)s)")
    parser.add_argument("--image", type=Path, help="file of the figure; none by default")
    options = parser.parse_args()
    check_scans(drive(hall(1.0, options.width), 0.5, 1), 0.5)
    curves = {}
    print(f"{'walls':>8} {'map':>8} {'model':>17} {'scans':>8}  ahead of the truth [m]: mean, SD; best offset")
    for thickness_m in (0.05, 0.3, 1.0):
        plan = hall(thickness_m, options.width)
        drives = [drive(plan, 0.5, seed) for seed in range(options.seeds)]
        near = next(moment for moment in drives[0] if moment.truth.x_m > WALL_X_M - 2.0)
        for (map_name, occupied), name in itertools.product(maps_of(plan).items(), MODELS):
            model = SensorModel(occupied, name)
            curve = curves[thickness_m, map_name, name] = scores(model, near)
            best = OFFSETS_M[curve >= curve.max() * 0.999]
            for exact in (False, True) if name == MODELS[0] else (False,):
                ends_m = [final_offset_m(model, moments, seed, exact) for seed, moments in enumerate(drives)]
                print(
                    f"{thickness_m:6.2f} m {map_name:>8} {name:>17} {'Shapely' if exact else 'ours':>8}"
                    f"  {np.mean(ends_m):+.3f}, {np.std(ends_m, ddof=1):.3f}; {best[0]:+.2f} to {best[-1]:+.2f}",
                    flush=True,
                )
    if options.image:
        draw(curves, options.image)


def draw(curves: dict[tuple[float, str, str], np.ndarray], path: Path) -> None:
    """Draw the scores over the offset."""
    mpl.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(7, 3.2), layout="constrained")
    colours = {0.05: palette.GREEN, 0.3: palette.ORANGE, 1.0: palette.BLUE}
    for (thickness_m, map_name, model), curve in curves.items():
        if model != MODELS[0]:
            continue
        style = "-" if map_name == "solid" else ":"
        label = f"walls of {thickness_m:g} m, {'solid' if map_name == 'solid' else 'only outlines'}"
        axes.plot(OFFSETS_M, curve / curve.max(), style, color=colours[thickness_m], label=label)
    axes.axvline(0.0, color=palette.AXIS, linewidth=0.8)
    axes.set(xlabel="offset of the pose along the heading [m]", ylabel="weight over the largest", ylim=(0.0, 1.05))
    axes.legend(fontsize=8, loc="lower left")
    figure.savefig(path, dpi=120)


if __name__ == "__main__":
    main()
