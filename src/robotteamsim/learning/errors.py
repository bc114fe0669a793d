"""The error of environments."""

from robotteamsim.errors import RobotTeamSimError


class LearningError(RobotTeamSimError, ValueError):
    """An environment cannot be made of a scenario, an action is not of its space, or methods are in the wrong order."""
