"""A few kills by the script that does a hundred."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

SCRIPT = Path(__file__).parents[3] / "study" / "reliability" / "campaign_kills.py"


def test_campaign_killed_at_random_moments_completes_to_the_same_bytes():
    command = [sys.executable, str(SCRIPT), "--kills", "3", "--trials", "20"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stderr
    campaigns, workers = map(int, re.findall(r"(\d+) campaigns and (\d+) workers killed", done.stdout)[0])
    assert campaigns + workers == 3
    assert re.search(r"[1-9]\d* campaigns completed, all to the same bytes", done.stdout)
