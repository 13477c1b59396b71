"""What is wrong with a configuration, as C++ says it, in the words of a command: its file named once, and which key of
those that there are may be meant."""

from __future__ import annotations

import re
from pathlib import Path

from pilotfish.data import did_you_mean

_UNKNOWN_KEY = re.compile(r"(?P<key>[\w.\[\]-]+): is not a known key here; known: (?P<known>\w+(?:, \w+)*)")


def in_file(message: str, file: str | Path) -> str:
    """The message with its file before it, and nowhere else."""
    said = message.replace(f" (in {file})", "").removeprefix("file: ")
    return said if str(file) in said else f"{file}: {said}"


def with_meant_key(message: str) -> str:
    """The message, with the known key that is nearest to one that is not known."""
    found = _UNKNOWN_KEY.search(message)
    if found is None:
        return message
    name = found["key"].rpartition(".")[2]
    meant = did_you_mean(name, found["known"].split(", "))
    return message[: found.start("key")] + message[found.start("key") :].replace(" here;", f" here{meant};", 1)
