"""The world of MuJoCo: bodies in three dimensions, with wheels, friction, rays and cameras.

The extra `mujoco`.
"""

import importlib
import os
import sys

from robotteamsim.errors import CameraError
from robotteamsim.wording import described

INSTALL_EGL = "install EGL, on Debian `apt-get install libegl1 libgl1-mesa-dri`"

_is_unset = sys.platform == "linux" and "MUJOCO_GL" not in os.environ
if _is_unset:
    # MuJoCo reads this when it is imported. Cameras draw without a screen, and in the same way with one.
    os.environ["MUJOCO_GL"] = "egl"

try:
    try:
        importlib.import_module("mujoco")
    except AttributeError:  # of OpenGL on a computer without EGL, which only cameras need
        if not _is_unset:
            raise
        os.environ["MUJOCO_GL"] = "off"
        importlib.import_module("mujoco")
except ImportError:
    raise
except Exception as error:  # it raises errors of many types where it cannot use the OpenGL that MUJOCO_GL names
    raise CameraError(
        f"MUJOCO_GL={os.environ.get('MUJOCO_GL')}: mujoco cannot be imported with this environment variable "
        f"({described(error)}); unset it to draw no images, or set it to egl and {INSTALL_EGL}"
    ) from error
