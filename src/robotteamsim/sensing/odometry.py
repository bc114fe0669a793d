"""Odometry: the true motion of robots plus drift."""

from collections.abc import Sequence

import numpy as np

_STEPS_PER_DRAW = 64


class OdometryNoise:
    """The random numbers of a team's odometry: true motion plus drift, in frames `odom` that start where robots do.

    The drift follows the odometry motion model [thrun2005, Table 5.6]: a motion is a turn, a distance and a second
    turn, each with Gaussian noise of the variances

        turns:    alpha1 turn^2 + alpha2 distance^2
        distance: alpha3 distance^2 + alpha4 (first turn^2 + second turn^2)

    so a robot that does not move, blocked or not, does not drift. The model leaves two cases open. When the robot
    drives backward, the distance is negative, because the robot did not turn round. A robot that slides or is pushed
    aside has turned only as much as its body did, not in the direction of its motion.

    An omnidirectional robot turns while it drives, and has errors sideways as well as along its path. Its motion is a
    distance, a sideways distance, which is 0 except for noise, and a turn, as in amcl's omnidirectional model [amcl]:

        turn:                   alpha1 turn^2 + alpha2 distance^2
        distance, and sideways: alpha3 distance^2 + alpha4 turn^2

    The covariance of the odometry pose is propagated step by step with the Jacobians of this model at that pose. This
    is a first-order approximation, valid while the yaw error is small, up to about 0.3 rad.
    """

    def __init__(self, generators: Sequence[np.random.Generator]) -> None:
        """Args: generators: of each robot; each gives three numbers per step."""
        self._generators = list(generators)
        self._noise = np.empty((_STEPS_PER_DRAW, len(self._generators), 3))
        self._noise_left: list[np.ndarray] = []
        """Rows of drawn noise, the next one last."""

    def restart(self, robot_id: int, generator: np.random.Generator) -> None:
        """Go on with a new generator for a robot that has arrived (again)."""
        self._generators[robot_id] = generator
        if self._noise_left:
            steps = len(self._noise_left)
            self._noise[-steps:, robot_id] = generator.standard_normal((steps, 3))

    def next(self) -> np.ndarray:
        """Return standard normal numbers for the next step, shape (n, 3)."""
        if not self._noise_left:
            for robot_id, generator in enumerate(self._generators):
                self._noise[:, robot_id] = generator.standard_normal((_STEPS_PER_DRAW, 3))
            self._noise_left = list(self._noise[::-1])
        return self._noise_left.pop()
