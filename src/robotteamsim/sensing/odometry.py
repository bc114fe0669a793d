"""Odometry: what robots believe of their ways from what they really did."""

from collections.abc import Sequence

import numpy as np

from robotteamsim import _core
from robotteamsim.scenario.sections import Odometry as OdometryModel
from robotteamsim.world import World

_STEPS_PER_DRAW = 64


class TeamOdometry:
    """The odometry of a team: true motion plus drift, in frames `odom` that begin where the robots do.

    The drift is that of the odometry motion model [thrun2005, Table 5.6]: a motion is a turn, a distance and a second
    turn, each with Gaussian noise of the variances

        turns:    alpha1 turn^2 + alpha2 distance^2
        distance: alpha3 distance^2 + alpha4 (first turn^2 + second turn^2)

    so a robot that stands still, blocked or not, does not drift. Two cases that the model leaves open: a distance is
    negative when the robot drives backwards, as turning round was no part of that; and a robot that is pushed aside
    or slides has turned no more than its body did, whatever the direction it went.

    An omnidirectional robot turns while it goes, and errs to the side of its way as along it. Its motion is a distance,
    a way to the side, which is none but for noise, and a turn, as amcl's omnidirectional model has them [amcl]:

        turn:                alpha1 turn^2 + alpha2 distance^2
        distance, and aside: alpha3 distance^2 + alpha4 turn^2

    The covariance of the believed pose is carried on step by step by the Jacobians of this model at that pose:
    to first order, so it holds while the error of yaw is small, up to 0.3 rad or so.
    """

    def __init__(
        self,
        models: Sequence[OdometryModel],
        step_s: float,
        generators: Sequence[np.random.Generator],
        omni: Sequence[bool] | None = None,
    ) -> None:
        """Begin at (0, 0, 0). Generators, one a robot, give three numbers a step: equal streams give equal drifts.

        Args: omni: whether each robot is omnidirectional; none: none is.
        """
        alphas = [(model.alpha1, model.alpha2, model.alpha3, model.alpha4) for model in models]
        self.core = _core.sensing.TeamOdometry(alphas, step_s, [False] * len(alphas) if omni is None else list(omni))
        """The C++ odometry, for the sensors of a team."""
        self._generators = list(generators)
        self._noise = np.empty((_STEPS_PER_DRAW, len(self._generators), 3))
        self._noise_left: list[np.ndarray] = []
        """Rows of it, the next one last."""

    def step(self, motions: np.ndarray, twists: np.ndarray) -> np.ndarray:
        """Return the readings after one more step, float64, shape (n, 16).

        A row is the pose in `odom` as x, y [m], qz, qw, and the twist in `base_link` that the wheels measured: forward,
        left [m/s], counter-clockwise [rad/s]; then the covariances of `OdometryReading`, six and three.

        Args: motions: the ways of the step, seen from where they began, shape (n, 3): x, y [m], yaw [rad].
              twists: their mean velocities, in `base_link`, shape (n, 3).
        """
        return self.core.step(motions, twists, self.next_noise())

    def follow(self, world: World) -> np.ndarray:
        """Return what `step` does, for the step that a world of as many robots made last."""
        return self.core.follow(world.core, self.next_noise())

    def restart(self, robot_id: int, generator: np.random.Generator) -> None:
        """Begin a robot's odometry anew at (0, 0, 0), where it has come (again), with a generator of its own."""
        self.core.restart(robot_id)
        self._generators[robot_id] = generator
        if self._noise_left:
            steps = len(self._noise_left)
            self._noise[-steps:, robot_id] = generator.standard_normal((steps, 3))

    def next_noise(self) -> np.ndarray:
        """Draw what one step takes, shape (n, 3)."""
        if not self._noise_left:
            for robot_id, generator in enumerate(self._generators):
                self._noise[:, robot_id] = generator.standard_normal((_STEPS_PER_DRAW, 3))
            self._noise_left = list(self._noise[::-1])
        return self._noise_left.pop()
