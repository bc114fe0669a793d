"""Errors caused by users. Each message is one line that names the place, the value and what was expected."""

from collections.abc import Mapping


class RobotTeamSimError(Exception):
    """Base class of all errors that the shells report in one line, without a traceback."""


class ScenarioError(RobotTeamSimError):
    """A scenario, floor plan or map file, or an override, is wrong."""


class UnfinishedImportError(ScenarioError):
    """A file cannot be imported, perhaps before the user has corrected `tables`; see `formats.Imported`."""

    def __init__(self, message: str, tables: Mapping[str, str]) -> None:
        super().__init__(message)
        self.tables = tables


class PlacementError(ScenarioError):
    """A robot, object, area, victim or door has an impossible position; `key` is its key in the scenario, if any."""

    def __init__(self, message: str, key: str = "") -> None:
        super().__init__(message)
        self.key = key


class RecordingError(RobotTeamSimError):
    """A result could not be written or read."""


class PhysicsError(RobotTeamSimError):
    """The physics of a world failed, although its input was valid."""


class SensorError(RobotTeamSimError):
    """A sensor, such as one of a user's own package, has failed."""


class CameraError(RobotTeamSimError):
    """The image of a camera cannot be drawn."""


class CampaignError(RobotTeamSimError):
    """A campaign cannot be run, stored or resumed."""
