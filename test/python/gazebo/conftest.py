"""Only Debian 12 has sdformat (see setup/debian-packages.txt), so only there exported worlds are checked with it."""

from __future__ import annotations

from pathlib import Path

_RELEASE = Path("/etc/os-release")
_IS_BOOKWORM = _RELEASE.is_file() and "VERSION_CODENAME=bookworm" in _RELEASE.read_text(encoding="utf-8").splitlines()

collect_ignore = [] if _IS_BOOKWORM else ["test_sdformat.py"]
