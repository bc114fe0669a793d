"""The documentation refers only to files, headings, keys and commands that exist."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from robotteamsim.cli.command_line import make_parser
from robotteamsim.scenario import load

ROOT = Path(__file__).parents[3]
FOLDERS = (".", "docs", "study", "study/*", "bench")
PAGES = sorted(page for folder in FOLDERS for page in ROOT.glob(f"{folder}/*.md"))

pages = pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))


def headings(page: Path) -> set[str]:
    """Return the anchors of a page."""
    titles = re.findall(r"^#+ (.*)$", re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


@pages
def test_links_lead_to_files_and_headings(page):
    broken = []
    for link in re.findall(r"\]\(([^)\s]+)\)", page.read_text()):
        name, _, anchor = link.partition("#")
        target = page.parent / name if name else page
        if not link.startswith("http") and not (target.exists() and (not anchor or anchor in headings(target))):
            broken.append(link)
    assert broken == []


@pages
def test_paths_that_are_named_exist(page):
    text = page.read_text()
    paths = re.findall(r"`((?:src|include|test|bench|study|docs|setup|scripts|templates|launch)/[\w/]+\.\w+)`", text)
    assert [path for path in paths if not (ROOT / path).exists()] == []


@pages
def test_commands_that_are_shown_are_accepted_by_the_parser(page):
    blocks = re.findall(r"```(?:sh)?\n(.*?)```", page.read_text(), re.DOTALL)
    lines = [line for block in blocks for line in block.replace("\\\n", " ").splitlines()]
    for line in lines:
        match = re.match(r"(?:\w+=\S+ )*robotteamsim ([a-z].*)", line)
        if match:
            words = shlex.split(match[1].split("  #")[0].split(" | ")[0], comments=True)
            make_parser().parse_args(words)


@pages
def test_launch_files_that_are_shown_exist(page):
    names = re.findall(r"roslaunch robotteamsim (\w+\.launch)", page.read_text())
    assert [name for name in names if not (ROOT / "launch" / name).is_file()] == []


@pages
def test_keys_that_are_set_in_examples_exist(page):
    for setting in re.findall(r"--set ([a-z]\w*(?:\.\w+)+=[^\s'`]+)", page.read_text()):
        if not setting.startswith(("schedule.", "control.algorithm=m", "run.world=s")):  # Need a part of the reader.
            load("garage_unknown" if setting.startswith("control.mapping.") else "garage_sar", [setting])
