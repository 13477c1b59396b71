"""One part of a campaign's rows: ``runs/part-000001-0123456789abcdef.parquet``.

The name ends in a checksum of the content and of the campaign: the first 16 hexadecimal digits of the SHA-256 of both.
It stands in the name because that is there as soon as the part is, and not before. A part that was altered, or comes
from another campaign, does not match it. Parts without a checksum, which earlier versions wrote, are read as far as
they can be.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pilotfish.errors import CampaignError
from pilotfish.extras import require

_NAME = re.compile(r"part-(?P<number>\d+)(?:-(?P<checksum>[0-9a-f]{16}))?\.parquet")


class DamagedPartError(Exception):
    """Why a part cannot be believed."""


def part_name(number: int, identity: Mapping[str, Any], content: bytes) -> str:
    """The name of a file with this content, in a folder of this campaign."""
    return f"part-{number:06d}-{_checksum(identity, content)}.parquet"


def part_number(part: Path) -> int:
    """The number in its name; 0 if it has none."""
    named = _NAME.fullmatch(part.name)
    return int(named["number"]) if named else 0


def read_part(part: Path, identity: Mapping[str, Any]) -> Any:
    """pyarrow's table of its rows. DamagedPartError if it is not what was written; CampaignError if it cannot be read
    just now."""
    try:
        content = part.read_bytes()
    except OSError as error:
        raise CampaignError(f"{part}: cannot be read ({error.strerror})") from error
    named = _NAME.fullmatch(part.name)
    if named is None:
        raise CampaignError(f"{part}: not a name that `pilotfish sweep` gives; move it out of {part.parent}")
    if named["checksum"] and named["checksum"] != _checksum(identity, content):
        raise DamagedPartError("damaged, or of another campaign (its content does not match the checksum in its name)")
    return _parsed(content, identity)


def _checksum(identity: Mapping[str, Any], content: bytes) -> str:
    return hashlib.sha256(json.dumps(identity, sort_keys=True).encode() + content).hexdigest()[:16]


def _parsed(content: bytes, identity: Mapping[str, Any]) -> Any:
    """The table, checked as far as one without a checksum can be."""
    arrow, parquet = require("pyarrow", "sweep"), require("pyarrow.parquet", "sweep")
    try:
        # In this thread: once, after a damaged part, the process ended in the destructor of one of Arrow's.
        table = parquet.ParquetFile(arrow.BufferReader(content)).read(use_threads=False)
        table.validate(full=True)
    except (arrow.ArrowException, OSError, KeyError, ValueError, MemoryError) as error:
        said = str(error).splitlines() or [type(error).__name__]
        raise DamagedPartError(f"damaged ({said[0]})") from error
    columns = ["run", "point", "repetition", *identity["factors"], "world_seed", "noise_seed", "outcome", "reason"]
    if table.column_names != [*columns, *identity["metrics"]]:
        raise DamagedPartError("damaged, or of another campaign (its columns are others)")
    whole, text, number = arrow.int64(), arrow.string(), arrow.float64()
    kinds = dict.fromkeys(("run", "point", "repetition", "world_seed", "noise_seed"), whole)
    kinds |= {"outcome": text, "reason": text} | dict.fromkeys(identity["metrics"], number)
    if any(table.schema.field(name).type != kind for name, kind in kinds.items()):
        raise DamagedPartError("damaged (its columns are of other kinds)")
    runs = table["run"].to_pylist()
    if any(run is None or run < 0 for run in runs) or len(set(runs)) < len(runs):
        raise DamagedPartError("damaged (its numbers of runs are not those of a campaign)")
    return table
