"""Finds slam_gmapping for `mapping.launch`; its failure ends the launch before any node starts."""

import sys

from robotteamsim.ros.programs import installed

PACKAGE, PROGRAM = "gmapping", "slam_gmapping"


def main() -> None:
    """Print the path of slam_gmapping; if it is not installed, exit with one line and status 2."""
    path = installed(PACKAGE, PROGRAM)
    if path is None:
        sys.stderr.write(
            f"mapping.launch: {PROGRAM} (ROS package {PACKAGE}) is not installed; install it, or use scenario.launch"
            " with another program that subscribes to base_scan and tf\n"
        )
        sys.exit(2)
    sys.stdout.write(path)
