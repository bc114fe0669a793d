"""Odometry: the true motion of robots plus drift."""

from collections.abc import Sequence

import numpy as np

from robotteamsim import _core
from robotteamsim.scenario.sections import Odometry as OdometryModel

_STEPS_PER_DRAW = 64


class TeamOdometry:
    """The odometry of a team: true motion plus drift, in frames `odom` that start at the robots' start poses.

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

    def __init__(
        self,
        models: Sequence[OdometryModel],
        step_s: float,
        generators: Sequence[np.random.Generator],
        omni: Sequence[bool] | None = None,
    ) -> None:
        """Start at (0, 0, 0). Each robot's generator gives three numbers per step.

        Args: omni: whether each robot is omnidirectional; None if none is.
        """
        alphas = [(model.alpha1, model.alpha2, model.alpha3, model.alpha4) for model in models]
        self._core = _core.sensing.TeamOdometry(alphas, step_s, [False] * len(alphas) if omni is None else list(omni))
        self._generators = list(generators)
        self._noise = np.empty((_STEPS_PER_DRAW, len(self._generators), 3))
        self._noise_left: list[np.ndarray] = []
        """Rows of drawn noise, the next one last."""

    def step(self, motions: np.ndarray, twists: np.ndarray) -> _core.sensing.OdometryState:
        """Return the readings after one more step, as arrays.

        Args: motions: of the step, in the frame of the pose at its beginning, shape (n, 3): x, y [m], yaw [rad].
              twists: their mean velocities, in `base_link`, shape (n, 3).
        """
        return self._core.step(motions, twists, self._next_noise())

    def read_team(self, team: _core.world.TeamMotion) -> _core.sensing.TeamState:
        """Return the state of the team after one more step, with the readings of `step`."""
        return self._core.read_team(team, self._next_noise())

    def restart(self, robot_id: int, generator: np.random.Generator) -> None:
        """Restart the odometry of a robot that has arrived (again) at (0, 0, 0), with a new generator."""
        self._core.restart(robot_id)
        self._generators[robot_id] = generator
        if self._noise_left:
            steps = len(self._noise_left)
            self._noise[-steps:, robot_id] = generator.standard_normal((steps, 3))

    def _next_noise(self) -> np.ndarray:
        """Draw the noise of one step, shape (n, 3)."""
        if not self._noise_left:
            for robot_id, generator in enumerate(self._generators):
                self._noise[:, robot_id] = generator.standard_normal((_STEPS_PER_DRAW, 3))
            self._noise_left = list(self._noise[::-1])
        return self._noise_left.pop()
