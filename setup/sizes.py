"""Print how large the parts of the project are, and how much they have grown since a commit.

Lines are those of files under version control, without three.js; words those of prose. Usage: setup/sizes.py COMMIT
"""

from __future__ import annotations

import subprocess
import sys
from collections import Counter

PROSE = ("docs/*.md", "study/*.md", "README.md", "CHANGELOG.md")
FOREIGN = "three."


def main(commit: str) -> None:
    """Print the table."""
    before, now = sizes(commit), sizes(None)
    print(f"{'lines, and words of prose':42} {commit[:12]:>12} {'now':>8} {'grown':>8}")
    for part in sorted(before | now):
        print(f"{part:42} {before[part]:12,} {now[part]:8,} {now[part] - before[part]:+8,}")


def sizes(commit: str | None) -> Counter[str]:
    """Return the size of each part in a commit, or in the working tree."""
    found: Counter[str] = Counter()
    for line in searched("-c", commit, "src", "include", "test"):
        path, _, count = line.removeprefix(f"{commit}:").rpartition(":")
        if FOREIGN not in path:
            for part in parts(path):
                found[part] += int(count)
    for files in PROSE:
        found[f"words of {files}"] = sum(len(line.split()) for line in searched("-h", commit, files))
    return found


def searched(option: str, commit: str | None, *paths: str) -> list[str]:
    """Return what git says of the lines of text files."""
    command = ["git", "grep", "-I", option, "", *([commit] if commit else []), "--", *paths]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()


def parts(path: str) -> tuple[str, ...]:
    """Return the names under which a file counts."""
    top, *rest = path.split("/")
    if top == "test":
        return ("test",)
    if rest[0] != "robotteamsim" or top == "include":
        return ("src and include", "src and include: C++")
    return ("src and include", f"src and include: robotteamsim.{rest[1] if len(rest) > 2 else '*'}")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
