"""The world of MuJoCo: bodies in three dimensions, with wheels, friction, rays and cameras.

An extra, `robotteamsim[mujoco]`.
"""

import os
import sys

if sys.platform == "linux":
    # MuJoCo reads this when it is imported. Cameras draw without a screen, and in the same way with one.
    os.environ.setdefault("MUJOCO_GL", "egl")
