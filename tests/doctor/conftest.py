"""A machine made of a few files, for the checks to look at."""

import subprocess
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from pilotfish.doctor import Host


@dataclass(frozen=True)
class FakeHost(Host):
    """A machine whose files are below `root`, and whose other answers are given."""

    answers: dict[str, object] = field(default_factory=dict)
    closed: frozenset[str] = frozenset()

    def may_use(self, file):
        return file.name not in self.closed

    def is_root(self):
        return bool(self.answers.get("root", False))

    def limit(self, which):
        return self.answers["limits"][which]

    def free_bytes(self, folder):
        return self.answers["free"]

    def clock_is_synchronized(self):
        return self.answers["synchronized"]

    def run(self, command):
        """The answer of a program, or what a function makes of its words."""
        answer = self.answers.get(Path(command[0]).name)
        return answer(command) if callable(answer) else answer


@pytest.fixture
def machine(tmp_path):
    def make(files=None, closed=(), **answers):
        for name, text in (files or {}).items():
            file = tmp_path / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        return FakeHost(tmp_path, answers, frozenset(closed))

    return make


@pytest.fixture
def said():
    """The answer of a program."""
    return lambda returncode, stdout="", stderr="": subprocess.CompletedProcess([], returncode, stdout, stderr)
