"""Remembers what clang-tidy found clean, by everything that its answer depends on: so what has not changed is not
looked at again (docs/decisions/0044). Findings are never remembered.

The key of an answer is a hash of clang-tidy's version, the checks, the compiler's options, and path and whole content
of every file that the source includes, those of the system too. The compiler lists them anew each time, so a header
that gets in front of another one counts as well.
"""

from __future__ import annotations

import hashlib
import subprocess
from functools import cache
from pathlib import Path


@cache
def _content(path: Path) -> bytes:
    return hashlib.sha256(path.read_bytes()).digest()


@cache
def _version() -> bytes:
    return subprocess.run(["clang-tidy", "--version"], capture_output=True, check=True).stdout


def _included(directory: str, options: tuple[str, ...], source: Path) -> list[Path] | None:
    """The source and every file that it includes; None if the compiler cannot say it."""
    done = subprocess.run([*options, "-M", str(source)], cwd=directory, capture_output=True, text=True)
    if done.returncode != 0:
        return None
    names = done.stdout.replace("\\\n", " ").partition(": ")[2].replace("\\ ", "\0").split()
    return [Path(directory, name.replace("\0", " ")) for name in names]


class CleanAnswers:
    """In a folder, an empty file for each clean answer."""

    def __init__(self, folder: Path, rules: list[Path]) -> None:
        self.folder = folder
        self.rules = rules  # files on which every answer depends
        folder.mkdir(parents=True, exist_ok=True)

    def key(self, compiler: tuple[str, ...], source: Path, *options: str) -> str | None:
        """Of clang-tidy with these options on a source that is compiled so: (directory, compiler, options ...)."""
        directory, *words = compiler
        files = _included(directory, tuple(words), source)
        if files is None:
            return None
        parts = [_version(), repr((compiler, options)).encode()]
        for file in [*self.rules, *files]:
            parts += [str(file).encode(), _content(file)]
        return hashlib.sha256(b"\0".join(hashlib.sha256(part).digest() for part in parts)).hexdigest()

    def knows(self, key: str | None) -> bool:
        return key is not None and (self.folder / key).exists()

    def remember(self, key: str | None) -> None:
        if key is not None:
            (self.folder / key).touch()
