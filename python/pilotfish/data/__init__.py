"""Where the shipped data files are: scenarios, fuzzy sets, leaders, calibrations, configs.

An installed wheel carries them in this folder; a checkout (or a build tree, whose Python sources are links
into the checkout) has them in ``data/`` at the top of the repository.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable
from pathlib import Path

from pilotfish.errors import MissingFileError

_HERE = Path(__file__).resolve().parent
_CHECKOUT = _HERE.parents[2] / "data"


def root() -> Path:
    """The folder that holds ``scenarios/``, ``fuzzy/``, ``leaders/`` and ``config/``."""
    for candidate in (_HERE, _CHECKOUT):
        if (candidate / "scenarios").is_dir():
            return candidate
    raise MissingFileError(f"Pilotfish's data files are neither in {_HERE} (wheel) nor in {_CHECKOUT} (checkout)")


def path(name: str) -> Path:
    """The shipped file ``name``, for example ``path("scenarios/line.yaml")``."""
    file = root() / name
    if not file.exists():
        beside = sorted(str(other.relative_to(root())) for other in file.parent.glob("*") if other.is_file())
        there = ", ".join(beside) if beside else "nothing"
        raise MissingFileError(f"no shipped data file '{name}'; beside it there is: {there}")
    return file


def scenarios() -> dict[str, Path]:
    """The shipped scenarios by the names they can be asked for with."""
    return {file.stem: file for file in sorted((root() / "scenarios").glob("*.yaml"))}


def scenario(name: str) -> Path:
    """The shipped scenario ``name`` ("line", "line.yaml"). MissingFileError lists those there are, and what may be
    meant."""
    known = scenarios()
    stem = Path(name).stem if Path(name).suffix == ".yaml" else name
    if stem in known:
        return known[stem]
    raise MissingFileError(f"no shipped scenario '{name}'{did_you_mean(stem, known)}; there are: {', '.join(known)}")


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """ " (did you mean line?)", or nothing if no name is near."""
    near = difflib.get_close_matches(name, list(known), 1, cutoff=0.5)
    return f" (did you mean {near[0]}?)" if near else ""


def files() -> list[Path]:
    """Every shipped file, sorted by folder and name. Python's own files beside them are not among them."""
    top = root()
    folders = (folder for folder in sorted(top.iterdir()) if folder.is_dir() and folder.name != "__pycache__")
    return [
        file
        for folder in folders
        for file in sorted(folder.rglob("*"))
        if file.is_file() and "__pycache__" not in file.parts
    ]


def describe(file: Path) -> str:
    """The first sentence of the file's first comment; empty if it has none."""
    text = file.read_text(errors="replace")
    if file.suffix == ".xml":
        match = re.search(r"<!--(.*?)-->", text, re.DOTALL)
        return _first_sentence(match[1].split()) if match else ""
    words: list[str] = []
    for line in text.splitlines():
        if line.startswith("#") and not line.startswith("#!"):
            words += line.lstrip("# ").split()
        elif words:
            break
    return _first_sentence(words)


def _first_sentence(words: list[str]) -> str:
    """A full stop ends one where a capital follows: "(Fig. 6)" does not."""
    return re.split(r"(?<=\.)\s+(?=[A-Z])", " ".join(words), maxsplit=1)[0]


def find(name: str) -> Path:
    """The shipped file or folder meant by ``name``: its path below data/, with or without its suffix, or its bare name
    if no other file has it. MissingFileError says what may be meant."""
    top = root()
    known = {str(file.relative_to(top)): file for file in files()}
    wanted = name.strip("/").removeprefix("data/")
    folders = {str(parent): top / parent for path in known for parent in Path(path).parents if parent.name}
    if wanted in known or wanted in folders:
        return known.get(wanted) or folders[wanted]
    meant = [path for path in known if wanted in (path.rpartition(".")[0], Path(path).name, Path(path).stem)]
    if len(meant) == 1:
        return known[meant[0]]
    if meant:
        raise MissingFileError(f"'{name}' may be any of: {', '.join(meant)}")
    near = did_you_mean(wanted, [*known, *(Path(path).stem for path in known)])
    raise MissingFileError(f"no shipped file '{name}'{near}; `pilotfish data` lists them")
