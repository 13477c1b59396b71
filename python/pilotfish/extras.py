"""Packages that only some commands need: extras of pyproject.toml, imported when they are used."""

from __future__ import annotations

import importlib
from types import ModuleType

from pilotfish.errors import MissingPackageError


def require(module: str, extra: str) -> ModuleType:
    """The imported ``module``, or MissingPackageError with the command that installs the extra it belongs to."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        if error.name is None or error.name.split(".")[0] != module.split(".")[0]:
            raise  # the package is there, and misses something itself
        package = module.split(".")[0]
        raise MissingPackageError(f"this needs {package}: pip install 'pilotfish[{extra}]'") from error
