"""The user's cache folder."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from robotteamsim.cache import cached


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("ROBOTTEAMSIM_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


@pytest.fixture
def make() -> Callable[[], bytes]:
    """Return another result each time."""
    results = iter((b"first", b"second", b"third"))
    return lambda: next(results)


def test_same_content_gives_the_same_result_and_other_content_another(folder, make):
    assert [cached([b"a", b"b"], make), cached([b"a", b"b"], make), cached([b"ab"], make)] == [
        b"first",
        b"first",
        b"second",
    ]
    assert len(list(folder.iterdir())) == 2


@pytest.mark.parametrize("damage", [b"", b"x", b"mine" * 100, None])
def test_damaged_file_is_made_again(folder, make, damage):
    cached([b"a"], make)
    (file,) = folder.iterdir()
    file.write_bytes(file.read_bytes()[:-1] if damage is None else damage)
    assert cached([b"a"], make) == b"second"
    assert cached([b"a"], make) == b"second"


@pytest.mark.parametrize("place", ["", "file"])
def test_without_a_usable_folder_nothing_is_kept(tmp_path, monkeypatch, make, place):
    (tmp_path / "file").touch()
    monkeypatch.setenv("ROBOTTEAMSIM_CACHE", str(tmp_path / place) if place else "")
    assert [cached([b"a"], make), cached([b"a"], make)] == [b"first", b"second"]
    assert (tmp_path / "file").read_bytes() == b""


def test_nothing_is_kept_of_what_fails(folder, make):
    with pytest.raises(ZeroDivisionError):
        cached([b"a"], lambda: b"%d" % (1 // 0))
    assert not folder.exists()
    assert cached([b"a"], make) == b"first"
