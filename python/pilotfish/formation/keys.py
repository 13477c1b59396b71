"""A mapping of a YAML file, read strictly: what is missing, unknown, of the wrong kind or out of range is a ConfigError
that names key, value and what is allowed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import yaml

from pilotfish.data import did_you_mean
from pilotfish.errors import ConfigError
from pilotfish.files import read_text


def config_error(key: str, problem: str, file: str | Path = "") -> ConfigError:
    """ConfigError "FILE: KEY: problem" with its ``key``."""
    error = ConfigError(f"{file}: {key}: {problem}" if file else f"{key}: {problem}")
    error.key = key
    return error


class _Loader(yaml.SafeLoader):
    """A key that stands twice is an error, not the last one."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        said = [self.construct_object(key, deep=True) for key, _ in node.value]
        twice = {str(key) for key in said if said.count(key) > 1}
        if twice:
            raise yaml.MarkedYAMLError(problem=f"{', '.join(sorted(twice))} stands twice", problem_mark=node.start_mark)
        return super().construct_mapping(node, deep)


def read_mapping(file: Path) -> dict[str, Any]:
    """What the YAML file says at its top level. ConfigError if it is no YAML or no mapping."""
    try:
        content = yaml.load(read_text(file, ConfigError), _Loader)
    except (yaml.YAMLError, RecursionError, TypeError, ValueError) as error:
        if isinstance(error, ConfigError):
            raise
        raise ConfigError(f"{file}: not YAML: {' '.join(str(error).split())}") from error
    if not isinstance(content, dict):
        raise ConfigError(f"{file}: a formation is a mapping with the keys name, shape, robots, ...")
    return {str(key): value for key, value in content.items()}


class Keys:
    """The entries of one mapping; ``finish`` refuses those that nobody asked for."""

    def __init__(self, content: Mapping[str, Any], file: Path, where: str = "") -> None:
        self._content, self._file, self._where, self._asked = content, file, where, set[str]()

    def error(self, key: str, problem: str) -> ConfigError:
        """ConfigError about a key of this mapping."""
        return config_error(f"{self._where}{key}", problem, self._file)

    def has(self, key: str) -> bool:
        """Whether it is there; it may be."""
        self._asked.add(key)
        return key in self._content

    def number(self, key: str, default: float | None, low: float, high: float) -> float:
        """A finite number from low to high; without a default it must be there."""
        value = self._value(key, default)
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            raise self.error(key, f"{value!r} is not a number; allowed: {low:g} to {high:g}")
        if not low <= value <= high:
            raise self.error(key, f"{value:g} is out of range; allowed: {low:g} to {high:g}")
        return float(value)

    def integer(self, key: str, default: int | None, low: int, high: int) -> int:
        """A whole number from low to high."""
        value = self._value(key, default)
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            raise self.error(key, f"{value!r} is not allowed: a whole number from {low} to {high}")
        return value

    def text(self, key: str, default: str | None = None, choices: Iterable[str] = ()) -> str:
        """A text; one of the choices, if there are any."""
        value, known = self._value(key, default), list(choices)
        if not isinstance(value, str):
            raise self.error(key, f"{value!r} is not a text")
        if known and value not in known:
            raise self.error(key, f"'{value}' is not one of {', '.join(known)}{did_you_mean(value, known)}")
        return value

    def mapping(self, key: str, default: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """A mapping, as it is."""
        value = self._value(key, default)
        if not isinstance(value, Mapping):
            raise self.error(key, f"{value!r} is not a mapping (key: value)")
        return {str(name): each for name, each in value.items()}

    def mappings(self, key: str) -> list[Keys]:
        """A list of mappings; an empty one if the key is not there."""
        value = self._value(key, [])
        if isinstance(value, str) or not isinstance(value, Sequence):
            raise self.error(key, f"{value!r} is not a list")
        for k, each in enumerate(value):
            if not isinstance(each, Mapping):
                raise self.error(f"{key}[{k}]", f"{each!r} is not a mapping (key: value)")
        named = [{str(name): each for name, each in entry.items()} for entry in value]
        return [Keys(each, self._file, f"{self._where}{key}[{k}].") for k, each in enumerate(named)]

    def finish(self) -> None:
        """ConfigError if there is a key that was not asked for."""
        for key in self._content:
            if key not in self._asked:
                known = sorted(self._asked)
                raise self.error(key, f"is not a key here{did_you_mean(key, known)}; there are: {', '.join(known)}")

    def _value(self, key: str, default: Any) -> Any:
        self._asked.add(key)
        value = self._content.get(key, default)
        if value is None:
            raise self.error(key, "is missing" if key not in self._content else "says nothing")
        return value
