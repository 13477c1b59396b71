"""What is skipped in builds with sanitizers; scripts/test says that it is one."""

from __future__ import annotations

import os

import pytest


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    if "PILOTFISH_SANITIZED" not in os.environ:
        return
    for item in items:
        if mark := item.get_closest_marker("not_sanitized"):
            item.add_marker(pytest.mark.skip(reason=f"not with sanitizers: {mark.args[0]}"))
