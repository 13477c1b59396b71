"""Recorded settings key by key, and where they differ between runs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import yaml

from pilotfish.logs.notes import Settings

_MAX_KEYS = 20_000  # of one file; anchors can make a short text endless
_MAX_DEPTH = 30


def keys_of(settings: Settings) -> dict[str, str]:
    """Dotted keys with the role of their file in front, "config: control.limits.max_linear_mps", and what they say.

    A text that is no YAML is one key, the file itself."""
    said = {f"command line: {word.partition('=')[0]}": word.partition("=")[2] for word in settings.overrides}
    for file in settings.files:
        try:
            content = yaml.safe_load(file.text)
        except (yaml.YAMLError, ValueError, RecursionError):
            content = file.text
        _flatten(content, f"{file.role}: ", said, 0, len(said) + _MAX_KEYS)
    return said


def differences(runs: Mapping[str, Settings]) -> dict[str, list[str | None]]:
    """By key, what each run says (None: nothing), where not all say the same. The program's version is a key, too."""
    tables = [{"program": settings.program} | keys_of(settings) for settings in runs.values()]
    names = list(dict.fromkeys(name for table in tables for name in table))
    rows = {name: [table.get(name) for table in tables] for name in names}
    return {name: values for name, values in rows.items() if len(set(values)) > 1}


def _flatten(content: Any, name: str, said: dict[str, str], depth: int, limit: int) -> None:
    if len(said) >= limit:
        return
    if depth >= _MAX_DEPTH:
        content = "…"
    joint = "" if name.endswith(": ") else "."
    if isinstance(content, dict) and content:
        for key, value in content.items():
            _flatten(value, f"{name}{joint}{key}", said, depth + 1, limit)
    elif isinstance(content, list) and any(isinstance(item, (dict, list)) for item in content):
        for at, value in enumerate(content):
            _flatten(value, f"{name}{joint}{at}", said, depth + 1, limit)
    else:
        said[name.removesuffix(": ")] = str(content)
