"""Exports scenarios to MJCF, the format of MuJoCo."""

from typing import Any

from robotteamsim.formats.exporter import Exported, Exporter
from robotteamsim.setup import Setup
from robotteamsim.wording import counted


class MujocoExporter(Exporter):
    """Exports a scenario at its start, see `world.mujoco.model.mjcf`."""

    help = "write a scenario for MuJoCo's viewer"
    suffix = "xml"
    description = """\
Write a scenario at its start in MJCF, with the same bodies as in `run.world: mujoco`, for
MuJoCo's viewer and other programs."""
    examples = """\
  robotteamsim plan export-mujoco garage_sar --out DIR       DIR/garage_sar.xml
  python -m mujoco.viewer --mjcf=DIR/garage_sar.xml"""

    def export(self, setup: Setup, **options: Any) -> Exported:
        """See `Exporter.export`."""
        from robotteamsim.world.mujoco.model import mjcf  # MuJoCo is an extra

        robots = counted(sum(robot.present for robot in setup.robots), "robot")
        summary = f"{robots}, {counted(len(setup.scenario.objects), 'object')}"
        return Exported(mjcf(setup.scenario, setup.robots), summary)
