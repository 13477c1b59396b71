"""Packages that only some commands need."""

from __future__ import annotations

import json
import sys

import pytest

from pilotfish.errors import MissingPackageError
from pilotfish.extras import require


def test_a_package_that_is_there_is_imported():
    assert require("json", "view") is json


def test_a_package_that_is_missing_is_named_with_the_command_that_installs_it():
    with pytest.raises(MissingPackageError, match=r"this needs no_such_package: pip install 'pilotfish\[view\]'"):
        require("no_such_package.part", "view")


def test_a_package_that_lacks_something_itself_is_not_called_missing(tmp_path, monkeypatch):
    (tmp_path / "needs_another.py").write_text("import no_such_package\n")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(ModuleNotFoundError, match="no_such_package") as caught:
        require("needs_another", "view")
    assert not isinstance(caught.value, MissingPackageError)
    assert "needs_another" not in sys.modules
