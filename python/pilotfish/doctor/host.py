"""The machine that is looked at: everything the checks read comes from here, so that a test can give them another."""

from __future__ import annotations

import ctypes
import os
import resource
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pilotfish.held_interrupts import HeldInterrupts

_COMMAND_TIMEOUT_S = 5.0


@dataclass(frozen=True)
class Host:
    """Paths below `root`; what is no file (limits, disk space, other programs) is asked for by methods."""

    root: Path = Path("/")

    def path(self, name: str) -> Path:
        """Where the file ``name``, absolute on the host, really is."""
        return self.root / name.lstrip("/")

    def read(self, name: str) -> str | None:
        """The file's text without the space around it; None if it cannot be read."""
        try:
            return self.path(name).read_text(errors="replace").strip()
        except OSError:
            return None

    def find(self, folder: str, pattern: str) -> list[Path]:
        """Files of a folder whose names match, sorted; empty if there is no such folder."""
        return sorted(self.path(folder).glob(pattern))

    def may_use(self, file: Path) -> bool:
        """Whether this user may read and write it."""
        return os.access(file, os.R_OK | os.W_OK)

    def run(self, command: Sequence[str | Path]) -> subprocess.CompletedProcess[str] | None:
        """None if there is no such program or it does not end."""
        try:
            with HeldInterrupts():  # an interrupt within subprocess can leave it waiting without end
                return subprocess.run(
                    [str(word) for word in command], capture_output=True, text=True, timeout=_COMMAND_TIMEOUT_S
                )
        except (OSError, subprocess.TimeoutExpired):
            return None

    def is_root(self) -> bool:
        """Whether this process has root's rights."""
        return os.geteuid() == 0

    def limit(self, which: int) -> int:
        """The soft limit of this process; -1: none. Services have limits of their own (their units)."""
        return resource.getrlimit(which)[0]

    def free_bytes(self, folder: Path) -> int:
        """Free space of the file system that the folder is on [bytes]. OSError if there is no such folder."""
        return shutil.disk_usage(folder).free

    def clock_is_synchronized(self) -> bool | None:
        """What the kernel says, whoever keeps its time; None if it does not say."""
        timex = ctypes.create_string_buffer(512)  # struct timex with modes = 0: only read
        state = ctypes.CDLL(None, use_errno=True).ntp_adjtime(timex)
        time_error = 5
        return None if state < 0 else state != time_error
