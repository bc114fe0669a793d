"""ROS 2 is not in this environment."""

from __future__ import annotations

import re
import subprocess
import sys


def test_start_without_a_sourced_ros2_ends_with_one_line():
    command = (sys.executable, "-m", "robotteamsim.ros2", "garage_sar")
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert re.fullmatch(r"robotteamsim\.ros2: this Python .* has no rclpy \(.*\); expected a ROS 2 .*\n", done.stderr)
