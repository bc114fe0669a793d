"""Which tests of ROS run in one process of pytest: those that share a master or a launch; all others run anywhere."""

from __future__ import annotations

import pytest

SHARED = {"run", "master", "ros", "cpp_driver"}
"""Fixtures that are made once for a module."""


@pytest.hookimpl(tryfirst=True)  # before pytest-xdist reads the groups
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Keep tests with a shared fixture together."""
    for item in items:
        if isinstance(item, pytest.Function) and SHARED & set(item.fixturenames):
            item.add_marker(pytest.mark.xdist_group(item.path.stem))
