"""Runs every .test file here by rostest, and tells what failed."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest
from running import ROSTEST, running

TESTS = sorted(Path(__file__).parent.glob("*.test"))


@pytest.mark.parametrize("path", TESTS, ids=lambda path: path.stem)
def test_rostest_passes(path: Path, tmp_path: Path) -> None:
    with running((*ROSTEST, str(path)), tmp_path) as program:
        program.wait()
    unfinished = unfinished_tests(path, tmp_path / "results")
    assert not unfinished, f"{', '.join(unfinished)}: ended before the results were written\n{program.output}"
    results = [ElementTree.parse(file).getroot() for file in (tmp_path / "results").rglob("*.xml")]
    cases = [case for result in results for case in result.iter("testcase")]
    failed = {
        case.get("name"): problem.text
        for case in cases
        for problem in (*case.findall("failure"), *case.findall("error"))
    }
    assert cases, program.output
    assert not failed, "\n".join((*(f"{name}: {text}" for name, text in failed.items()), program.output))
    # An error before the first test, as in setUpClass, has no case.
    numbers = [result.get(kind) for result in results for kind in ("errors", "failures")]
    assert set(numbers) == {"0"}, program.output


def unfinished_tests(path: Path, results: Path) -> list[str]:
    """Return the tests of a .test file that left no results; rostest itself calls them passed."""
    names = [test.get("test-name", "") for test in ElementTree.parse(path).iter("test")]
    files = {name: next(results.rglob(f"rosunit-{name}.xml"), None) for name in names}
    return [name for name, file in files.items() if file is None or not file.read_text().strip()]
