"""One run of the real programs for all tests here."""

from __future__ import annotations

import pytest
from recordings import Recorded, record


@pytest.fixture(scope="session")
def recorded(tmp_path_factory) -> Recorded:
    """Three seconds behind a leader on a line, 90 frames."""
    return record(tmp_path_factory.mktemp("recorded"), "line", "anticipate", 3.0)
