"""Paths of robots, from their true poses or from odometry and /tf."""

import itertools
import math
from collections import defaultdict
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from robotteamsim.message_parts import MAP_FRAME
from robotteamsim.simulation.trial import FASTEST_MPS, SHORTEST_JUMP_M

BEFORE_ALL_NS = -(2**62)
"""Stamp of transforms that are valid at all times."""
AFTER_ALL_NS = 2**62

Absence = tuple[int, int]
"""Stamps at which a robot left and at which it came again [ns]."""
Jump = tuple[int, float]
"""Stamp of the first pose after a jump [ns], and its length [m]."""

_RETURNS = 3
"""A localization that was wrong jumps to the right place, and perhaps once back, but not so often."""
_FARTHEST_M = 1e9
"""Farther than any place on the Earth, also in UTM coordinates: such poses are as impossible as NaN."""
_BASES = ("base_footprint", "base_link")


class PoseSample(NamedTuple):
    """A recorded pose: frame, position [m], unit quaternion."""

    frame: str
    x_m: float
    y_m: float
    qx: float
    qy: float
    qz: float
    qw: float


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """The path of a robot.

    source:    "truth", "odom", "pose" or "tf"; "odom and tf" if tf has placed it in the map.
    frame:     "map", or the frame of the odometry if no transform from map to it is recorded.
    stamps_ns: int64, shape (n,), ascending.
    poses:     float64, shape (n, 3): x, y [m], yaw [rad] in `frame`.
    turns:     float64, shape (n, 2): z and w of the quaternions as recorded.
    driven_m:  float64, shape (n,): length of the path so far [m], in the frame of the odometry if there is one, because
               that frame may jump in the map.
    absences:  intervals in which the robot was absent, in order.
    jumps:     faster than any robot, such as resets of the odometry: not driven.
    """

    source: str
    frame: str
    stamps_ns: np.ndarray
    poses: np.ndarray
    turns: np.ndarray
    driven_m: np.ndarray
    absences: tuple[Absence, ...] = ()
    jumps: tuple[Jump, ...] = ()

    @property
    def breaks(self) -> list[int]:
        """Indices of poses that are not connected to the previous one: the robot came again there, or jumped."""
        jumped = np.searchsorted(self.stamps_ns, [stamp_ns for stamp_ns, _ in self.jumps]).tolist()
        found = sorted({*_came(self.stamps_ns, self.absences), *jumped})
        return [index for index in found if 0 < index < len(self.stamps_ns)]

    def line(self, begin: int, end: int) -> np.ndarray:
        """Return the positions of the poses begin <= index < end, with NaN at the breaks, shape (m, 2) [m]."""
        breaks = [index - begin for index in self.breaks if begin < index < end]
        return np.insert(self.poses[begin:end, :2], breaks, np.nan, axis=0)

    def is_present(self, stamp_ns: int) -> bool:
        """Whether the robot is present at a stamp [ns]."""
        return not any(gone_ns <= stamp_ns < came_ns for gone_ns, came_ns in self.absences)

    @property
    def is_on_map(self) -> bool:
        """Whether the poses are in `map`."""
        return self.frame == MAP_FRAME

    def index_at(self, stamp_ns: int) -> int:
        """Return the index of the last pose at or before a stamp [ns], or 0 if there is none."""
        return max(int(np.searchsorted(self.stamps_ns, stamp_ns, side="right")) - 1, 0)


class Transforms:
    """Poses of frames in `map`, and of the robots' bases in their parents, from the topics tf and tf_static."""

    def __init__(self) -> None:
        self._places: dict[tuple[str, str], list[tuple[int, float, float, float]]] = defaultdict(list)
        self.bases: dict[str, list[tuple[int, PoseSample]]] = defaultdict(list)
        """Poses in the parent frame by the namespace of the robot: that of the topic, or the prefix of the frame."""

    def add(self, topic: str, recorded_ns: int, message: Any) -> None:
        """Add the transforms of a tf2_msgs/TFMessage. Args: recorded_ns: of those without a stamp."""
        namespace, _, kind = topic.rpartition("/")
        for transform in message.transforms:
            parent, child = transform.header.frame_id.lstrip("/"), transform.child_frame_id.lstrip("/")
            prefix, _, name = child.rpartition("/")
            is_base = name in _BASES and parent.rpartition("/")[2] not in _BASES
            if parent != MAP_FRAME and not is_base:
                continue
            stamp = transform.header.stamp
            stamp_ns = BEFORE_ALL_NS if kind == "tf_static" else stamp or recorded_ns
            place, q = transform.transform.translation, transform.transform.rotation
            if parent == MAP_FRAME:
                yaw_rad = float(_yaw_rad(q.x, q.y, q.z, q.w))
                self._places[namespace, child].append((stamp_ns, place.x, place.y, yaw_rad))
            if is_base and kind == "tf":
                sample = PoseSample(parent, place.x, place.y, q.x, q.y, q.z, q.w)
                self.bases[namespace or (prefix and f"/{prefix}")].append((stamp_ns, sample))

    def of(self, frame: str, namespace: str) -> tuple[np.ndarray, np.ndarray] | None:
        """Return stamps [ns], ascending, and x, y [m], yaw [rad] of a robot's frame in `map`, or None if it is unknown.

        The tf of the nearest namespace counts; there, the frame may lack the namespace as its prefix.
        """
        names = (frame, frame.removeprefix(f"{namespace.strip('/')}/"))
        while True:
            for name in names:
                if places := sorted(self._places.get((namespace, name), [])):
                    return np.array([place[0] for place in places]), np.array([place[1:] for place in places])
            if not namespace:
                return None
            namespace = namespace.rpartition("/")[0]

    def contradictions(self, frames: Collection[str]) -> list[str]:
        """Return a line for each place of such frames in `map` that goes back and forth, as if two robots sent it."""
        lines, names = [], {frame.rpartition("/")[2] for frame in frames}
        for (namespace, child), unsorted in self._places.items():
            stamps_ns, *place = np.array(sorted(unsorted)).T[:3]
            steps_m = np.hypot(*np.diff(place))
            jumps = np.flatnonzero(steps_m > SHORTEST_JUMP_M)
            back_m = np.hypot(*(np.take(place, jumps[1:] + 1, axis=1) - np.take(place, jumps[:-1], axis=1)))
            is_split = np.count_nonzero(2.0 * back_m < steps_m[jumps[:-1]]) >= _RETURNS
            if child.rpartition("/")[2] in names and (is_split or (np.diff(stamps_ns)[jumps] == 0.0).any()):
                what = f"jumps back and forth, the last time by {steps_m[jumps[-1]]:.1f} m, as if two robots sent it"
                why = f"paths in map are wrong; expected a frame per robot, such as robot_0/{child}"
                lines.append(f"{namespace}/tf: map to {child} {what}: {why}")
        return lines


def is_finite(pose: PoseSample) -> bool:
    """Return whether all numbers of a pose are finite, and no place is farther than any robot drives."""
    return all(abs(value) < _FARTHEST_M for value in pose[1:])


def from_truth(samples: Sequence[tuple[int, PoseSample]], absences: tuple[Absence, ...] = ()) -> Track | None:
    """Return the track of true poses in `map`, all finite, or None if there are none."""
    track = _track("truth", samples, absences)
    return track and replace(track, frame=MAP_FRAME)


def from_odometry(
    samples: Sequence[tuple[int, PoseSample]],
    transforms: Transforms,
    absences: tuple[Absence, ...] = (),
    *,
    namespace: str = "",
    source: str = "odom",
) -> Track | None:
    """Return the track of an odometry: in `map` from the first transform of its frame on, else in its own frame."""
    track = _track(source, samples, absences)
    placed = transforms.of(track.frame, namespace) if track else None
    if track is None or placed is None:
        return track
    place_stamps_ns, places = placed
    # Before the first transform, the robot's position in the map is unknown.
    first = int(np.searchsorted(track.stamps_ns, place_stamps_ns[0]))
    if first == len(track.stamps_ns):
        return track
    stamps_ns, poses = track.stamps_ns[first:], track.poses[first:]
    place = places[np.searchsorted(place_stamps_ns, stamps_ns, side="right") - 1]
    cos, sin = np.cos(place[:, 2]), np.sin(place[:, 2])
    on_map = np.column_stack(
        (
            place[:, 0] + cos * poses[:, 0] - sin * poses[:, 1],
            place[:, 1] + sin * poses[:, 0] + cos * poses[:, 1],
            place[:, 2] + poses[:, 2],
        )
    )
    turns, driven_m = track.turns[first:], track.driven_m[first:]
    source = source if source == "tf" else f"{source} and tf"
    return Track(source, MAP_FRAME, stamps_ns, on_map, turns, driven_m, absences, track.jumps)


def _track(source: str, samples: Sequence[tuple[int, PoseSample]], absences: tuple[Absence, ...]) -> Track | None:
    """Return the track of recorded poses in their own frame; None: no poses."""
    if not samples:
        return None
    stamps_ns = np.array([stamp_ns for stamp_ns, _ in samples])
    values = np.array([pose[1:] for _, pose in samples])
    poses = np.column_stack((values[:, :2], _yaw_rad(*values[:, 2:].T)))
    places, came = poses[:, :2].tolist(), _came(stamps_ns, absences)
    steps_m = np.array([0.0, *itertools.starmap(math.dist, itertools.pairwise(places))])
    steps_m[[index for index in came if index < len(steps_m)]] = 0.0
    possible_m = np.maximum(np.diff(stamps_ns, prepend=stamps_ns[0]) / 1e9 * FASTEST_MPS, SHORTEST_JUMP_M)
    jumped = np.flatnonzero(steps_m > possible_m)
    jumps = tuple(zip(stamps_ns[jumped].tolist(), steps_m[jumped].tolist(), strict=True))
    steps_m[jumped] = 0.0
    # The sum has the order of the trial's own totals, for the same bits.
    return Track(source, samples[0][1].frame, stamps_ns, poses, values[:, 4:], np.cumsum(steps_m), absences, jumps)


def _came(stamps_ns: np.ndarray, absences: Sequence[Absence]) -> list[int]:
    """Return the indices of the first poses after absences."""
    came_ns = np.array([came_ns for _, came_ns in absences], dtype=np.int64)
    indices: list[int] = np.searchsorted(stamps_ns, came_ns).tolist()
    return indices


def _yaw_rad(x: Any, y: Any, z: Any, w: Any) -> Any:
    return np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
