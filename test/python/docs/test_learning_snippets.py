"""The Python of docs/learning.md, literally as printed: each block runs by itself."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[3] / "docs" / "learning.md"
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
POLICY = next(block for block in BLOCKS if "my_policy.py" in block)

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("block", BLOCKS, ids=[block.splitlines()[-1].strip()[:40] for block in BLOCKS])
def test_each_block_runs_by_itself(block: str, tmp_path: Path) -> None:
    if "torch" in block:
        pytest.importorskip("torch", reason="PyTorch is not installed (extra train)")
    words = [sys.executable, "-W", "error", "-c", block]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_policy_of_the_page_drives_a_mission(tmp_path: Path) -> None:
    (tmp_path / "my_policy.py").write_text(POLICY, encoding="utf-8")
    words = ["run", "garage_sar", "--set", "control.algorithm=my_policy:Policy", "--set", "mission.time_limit_s=5"]
    path = os.pathsep.join((".", os.environ.get("PYTHONPATH", "")))
    done = subprocess.run(
        [sys.executable, "-m", "robotteamsim.cli", *words],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "fault" not in done.stdout
