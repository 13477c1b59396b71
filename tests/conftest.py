"""What is skipped in builds with sanitizers; scripts/test says that it is one. And what many modules' tests share."""

from __future__ import annotations

import os
from collections.abc import Iterator

import pytest


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    items.sort(key=lambda item: item.get_closest_marker("builds") is None)  # stable
    if "PILOTFISH_SANITIZED" not in os.environ:
        return
    for item in items:
        if mark := item.get_closest_marker("not_sanitized"):
            item.add_marker(pytest.mark.skip(reason=f"not with sanitizers: {mark.args[0]}"))


@pytest.fixture(scope="module")
def small_pictures() -> Iterator[None]:
    """Pictures of matplotlib with 50 dpi, not 150: for tests that do not look into them."""
    from pilotfish.plots import style

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(style, "DPI", 50)
        yield
