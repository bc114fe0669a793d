"""The world of MuJoCo: bodies in three dimensions, with wheels, friction, rays and cameras.

The extra `mujoco`.
"""

import os
import sys

from robotteamsim.errors import CameraError
from robotteamsim.wording import described

if sys.platform == "linux":
    # MuJoCo reads this when it is imported. Cameras draw without a screen, and in the same way with one.
    os.environ.setdefault("MUJOCO_GL", "egl")

try:
    import mujoco  # noqa: F401
except ImportError:
    raise
except Exception as error:  # it raises errors of many types where it cannot use the OpenGL that MUJOCO_GL names
    raise CameraError(
        f"MUJOCO_GL={os.environ.get('MUJOCO_GL')}: mujoco cannot be imported with this environment variable "
        f"({described(error)}); use egl, or off to draw no images"
    ) from error
