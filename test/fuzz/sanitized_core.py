"""Another build of the C++ as `robotteamsim._core`: for import_fuzz.py --core, and for pytest.

`ROBOTTEAMSIM_CORE=FILE python -m pytest -p sanitized_core`, this folder on PYTHONPATH, runs tests with that build;
`make sanitize` does so with the one under AddressSanitizer and UBSan.
"""

from __future__ import annotations

import importlib.util
import os
import sys
from pathlib import Path


def use_core(path: Path) -> None:
    """Make a build of the C++ the one that the package imports; it must not have imported one yet."""
    assert "robotteamsim" not in sys.modules
    spec = importlib.util.spec_from_file_location("robotteamsim._core", path)
    assert spec, f"{path} is no module"
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules["robotteamsim._core"] = module
    spec.loader.exec_module(module)


if "ROBOTTEAMSIM_CORE" in os.environ:
    use_core(Path(os.environ["ROBOTTEAMSIM_CORE"]))
