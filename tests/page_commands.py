"""The commands and the code that a page shows, so that tests can run what people copy."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sysconfig
from collections.abc import Callable
from pathlib import Path

from pilotfish import data as shipped
from pilotfish.harness.executables import SIM, find_executable

ROOT = Path(__file__).parents[1]


def blocks(page: str, language: str, section: str = "") -> list[str]:
    """The fenced blocks of a language, of a page named from the repository's root; of its ``section`` (a heading of the
    second level) alone."""
    text = (ROOT / page).read_text()
    if section:
        text = text.partition(f"\n## {section}\n")[2].partition("\n## ")[0]
    return re.findall(rf"```{language}\n(.*?)```", text, flags=re.DOTALL)


def commands(page: str, section: str = "") -> list[str]:
    """Every command line of a page, in order, without its comment. A line that ends in a backslash goes on."""
    text = "\n".join(blocks(page, "sh", section)).replace("\\\n", " ")
    return [command for line in text.splitlines() if (command := line.split("#")[0].strip())]


Desk = Callable[..., subprocess.CompletedProcess]


def desk_in(folder: Path, lcm_url: str) -> Desk:
    """Runs command lines in a folder in which the pages' relative paths hold, with Pilotfish's programs first on the
    PATH. What the pages call by `$(...)` a shell has to resolve."""
    if not (folder / "data").exists():
        (folder / "data").symlink_to(shipped.path("."))
    environment = {**os.environ, "PATH": path_with_programs(), "LCM_DEFAULT_URL": lcm_url}

    def run(command: str, **how) -> subprocess.CompletedProcess:
        words = ["sh", "-c", command] if "$(" in command else shlex.split(command)
        return subprocess.run(
            words, **{"cwd": folder, "env": environment, "timeout": 120, **how}, capture_output=True, text=True
        )

    return run


def path_with_programs() -> str:
    """What an activated environment has in PATH."""
    return os.pathsep.join([str(find_executable(SIM).parent), sysconfig.get_path("scripts"), os.environ["PATH"]])
