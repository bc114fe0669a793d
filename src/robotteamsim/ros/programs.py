"""Programs of other packages, which may be missing."""

import roslib.packages
import rospkg


def installed(package: str, program: str) -> str | None:
    """Return the full path of a program of a ROS package, or None."""
    try:
        found = roslib.packages.find_node(package, program)
    except rospkg.ResourceNotFound:
        return None
    return found[0] if found else None
