"""`make sizes` counts every line of the sources once."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path


def run(*command: str) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def test_sizes_are_those_that_a_count_of_the_files_gives():
    table = run(sys.executable, "setup/sizes.py", "HEAD").splitlines()[1:]
    now = {line[:42].strip(): int(line.split()[-2].replace(",", "")) for line in table}
    sources = run("git", "ls-files", "src", "include").splitlines()
    lines = [Path(file).read_text().count("\n") for file in sources if "three." not in file and Path(file).exists()]
    assert now["src and include"] == sum(lines)
    assert now["src and include"] == sum(size for part, size in now.items() if part.startswith("src and include:"))
    assert now["words of README.md"] == int(run("wc", "-w", "README.md").split()[0])
